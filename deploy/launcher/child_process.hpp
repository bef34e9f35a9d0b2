#pragma once
// A program that the launcher started: it cannot outlive the launcher, and all it says comes here.

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "deploy/launcher/launch_plan.hpp"

namespace couplet::launcher {

/// A piece of output. An update is written over by the next one (it began or ended with a carriage return); the last of
/// them ends its line.
struct OutputLine {
  std::string text;
  bool is_update = false;
  bool ends_line = true;
};

/// Cuts a stream of bytes into lines and updates.
class OutputSplitter {
 public:
  std::vector<OutputLine> add(const char* bytes, std::size_t n_bytes);
  /// What was left without an end of line.
  std::vector<OutputLine> finish();

 private:
  std::string pending_;
  bool after_return_ = false;  // the last byte was a carriage return: with a newline next it is an end of line
  bool is_update_ = false;     // what is pending began behind a carriage return
};

/// How a process ended: by itself with a code, or by a signal.
struct Ending {
  bool by_signal = false;
  int code = 0;  // exit code or number of the signal
};

class ChildProcess {
 public:
  /// Which of its streams the program sees as a terminal, so that it shows a progress line as if it had been started by
  /// hand.
  struct Terminals {
    bool output = false, errors = false;
  };

  /// Starts the program in a process group of its own, without standard input; one that is attended hears there what to
  /// do. Throws FileError when that is impossible.
  ChildProcess(const ProgramStart& start, Terminals terminals);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();  // kills it if it still runs

  pid_t pid() const { return pid_; }
  bool is_running() const { return !ending_; }
  const std::optional<Ending>& ending() const { return ending_; }
  /// Notes that it has ended, if it has.
  void look();
  void send_signal(int signal) const;
  /// To the program and all that it has started, or to those of them that have a name.
  void signal_tree(int signal) const;
  void signal_named(const std::string& name, int signal) const;
  /// It runs on another host, behind a remote shell; what is known of its processes is known there.
  bool is_attended() const { return words_ >= 0; }

  int output() const { return output_; }  // file descriptors to read from; -1 once closed
  int errors() const { return errors_; }
  /// What has arrived on one of them; closes it at its end.
  std::vector<OutputLine> read_output() { return read(output_, output_lines_); }
  std::vector<OutputLine> read_errors() { return read(errors_, error_lines_); }

 private:
  static std::vector<OutputLine> read(int& file, OutputSplitter& lines);
  void tell(const std::string& words) const;

  pid_t pid_ = -1;
  int output_ = -1, errors_ = -1;
  int words_ = -1;  // to the attendant; -1 when there is none
  OutputSplitter output_lines_, error_lines_;
  std::optional<Ending> ending_;
};

}  // namespace couplet::launcher
