#pragma once
// How a program says that it is not well. Five kinds, never mixed; each has its exit code (README, "Exit codes").

#include <functional>
#include <stdexcept>
#include <string>

namespace couplet::report {

enum class FailureKind {
  scene,     // the command line or the scene is wrong: exit code 2
  numerics,  // diverged, inverted, not a number: exit code 3
  peer,      // a participant or a connection was lost: exit code 4
  file,      // a file cannot be read or written: exit code 5
  bug,       // a fault of Couplet: exit code 70
};

int exit_code(FailureKind kind);

/// An end of the run that a user must hear about. `what()` is one line: where, what happened, what to do next.
class Failure : public std::runtime_error {
 public:
  Failure(FailureKind kind, std::string where, std::string sentence, std::string advice);

  FailureKind kind() const { return kind_; }
  const std::string& where() const { return where_; }        // scene field, file, element, time; may be empty
  const std::string& sentence() const { return sentence_; }  // what happened, with the value found
  const std::string& advice() const { return advice_; }      // what to do next; may be empty

 private:
  FailureKind kind_;
  std::string where_, sentence_, advice_;
};

struct SceneError : Failure {
  SceneError(std::string where, std::string sentence, std::string advice = {})
      : Failure(FailureKind::scene, std::move(where), std::move(sentence), std::move(advice)) {}
};
struct NumericsError : Failure {
  NumericsError(std::string where, std::string sentence, std::string advice = {})
      : Failure(FailureKind::numerics, std::move(where), std::move(sentence), std::move(advice)) {}
};
struct PeerError : Failure {
  PeerError(std::string where, std::string sentence, std::string advice = {})
      : Failure(FailureKind::peer, std::move(where), std::move(sentence), std::move(advice)) {}
};
/// Work that was given up half-way because the program was asked to end; nothing was wrong with it.
struct Interrupted : PeerError {
  explicit Interrupted(std::string where)
      : PeerError(std::move(where), "asked to end by a signal", "results are complete up to the last step") {}
};
struct FileError : Failure {
  FileError(std::string where, std::string sentence, std::string advice = {})
      : Failure(FailureKind::file, std::move(where), std::move(sentence), std::move(advice)) {}
};

/// A number as sentences show it, with six digits.
std::string text(double value);

/// Runs a program's body and turns whatever it throws into one last line on standard error and an exit code.
/// A Failure keeps its kind; any other exception is a bug (70). `program` starts the line.
int run_program(const std::string& program, const std::function<int(int, char**)>& body, int argc, char** argv);

}  // namespace couplet::report
