#pragma once
// A program in a process of its own, with what it prints.

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace couplet::participant {

class ChildProgram {
 public:
  explicit ChildProgram(std::vector<std::string> command) {
    int output[2], error[2];
    if (pipe2(output, O_CLOEXEC) != 0 || pipe2(error, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_ == 0) {
      dup2(output[1], STDOUT_FILENO);
      dup2(error[1], STDERR_FILENO);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    close(output[1]);
    close(error[1]);
    output_ = output[0];
    error_ = error[0];
  }
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ~ChildProgram() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(output_);
    close(error_);
  }

  void signal(int number) const { kill(process_, number); }

  /// The next line of its standard output, without the line feed; what there is when the output ends.
  std::string read_line() const {
    std::string line;
    for (char c; read(output_, &c, 1) == 1 && c != '\n';) line += c;
    return line;
  }

  /// Waits for its end; a program that was killed by a signal has the code 128 + signal.
  int exit_code() {
    rest_of_output_ = read_all(output_);
    errors_ = read_all(error_);
    int status = 0;
    waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  const std::string& output() const { return rest_of_output_; }  // after exit_code, without the lines that were read
  const std::string& errors() const { return errors_; }          // after exit_code

 private:
  // Little is printed, less than a pipe holds, so reading one after the other cannot block the program.
  static std::string read_all(int file) {
    std::string text;
    char block[4096];
    for (ssize_t n; (n = read(file, block, sizeof block)) > 0;) text.append(block, static_cast<std::size_t>(n));
    return text;
  }

  pid_t process_ = -1;
  int output_ = -1, error_ = -1;
  std::string rest_of_output_, errors_;
};

}  // namespace couplet::participant
