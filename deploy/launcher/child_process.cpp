#include "deploy/launcher/child_process.hpp"

#include <fcntl.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "deploy/launcher/process_tree.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

/// Two ends of a stream; what the program writes to `theirs` is read from `ours`.
struct Stream {
  int ours = -1, theirs = -1;
};

Stream make_stream(bool as_terminal) {
  int ends[2];
  if (as_terminal) {
    winsize size{};
    const bool has_size = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0;
    if (openpty(&ends[0], &ends[1], nullptr, nullptr, has_size ? &size : nullptr) == 0) {
      fcntl(ends[0], F_SETFD, FD_CLOEXEC);
      fcntl(ends[1], F_SETFD, FD_CLOEXEC);
      return {ends[0], ends[1]};
    }
  }
  if (pipe2(ends, O_CLOEXEC) != 0) throw report::FileError("pipe", std::strerror(errno), "close other programs");
  return {ends[0], ends[1]};
}

/// Between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* words, pid_t launcher, int input, int output, int errors) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != launcher) _exit(127);  // the launcher was already gone
  setpgid(0, 0);                          // Ctrl-C goes to the launcher, which tells the others
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  signal(SIGPIPE, SIG_DFL);
  dup2(input >= 0 ? input : open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  execvp(words[0], words);
  dprintf(STDERR_FILENO, "couplet: cannot start %s: %s\n", words[0], std::strerror(errno));
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const ProgramStart& start, Terminals terminals) {
  const Stream output = make_stream(terminals.output), errors = make_stream(terminals.errors);
  std::vector<char*> words;
  for (const std::string& word : start.command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  for (const auto& [name, value] : start.environment) setenv(name.c_str(), value.c_str(), 1);
  int input[2] = {-1, -1};
  if (start.is_attended && pipe2(input, O_CLOEXEC) != 0)
    throw report::FileError("pipe", std::strerror(errno), "close other programs");
  const pid_t launcher = getpid();
  pid_ = fork();
  if (pid_ == 0) become(words.data(), launcher, input[0], output.theirs, errors.theirs);
  if (input[0] >= 0) close(input[0]);
  words_ = input[1];
  close(output.theirs);
  close(errors.theirs);
  output_ = output.ours;
  errors_ = errors.ours;
  if (pid_ < 0) throw report::FileError(start.name, std::strerror(errno), "close other programs and try again");
  for (const int file : {output_, errors_}) fcntl(file, F_SETFL, fcntl(file, F_GETFL) | O_NONBLOCK);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      output_(std::exchange(other.output_, -1)),
      errors_(std::exchange(other.errors_, -1)),
      words_(std::exchange(other.words_, -1)),
      output_lines_(std::move(other.output_lines_)),
      error_lines_(std::move(other.error_lines_)),
      ending_(other.ending_) {}

ChildProcess::~ChildProcess() {
  if (pid_ > 0 && !ending_) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  for (const int file : {output_, errors_, words_}) {
    if (file >= 0) close(file);
  }
}

void ChildProcess::look() {
  int status = 0;
  if (ending_ || waitpid(pid_, &status, WNOHANG) != pid_) return;
  if (WIFEXITED(status)) ending_ = Ending{false, WEXITSTATUS(status)};
  if (WIFSIGNALED(status)) ending_ = Ending{true, WTERMSIG(status)};
}

void ChildProcess::send_signal(int signal) const {
  if (ending_) return;
  is_attended() ? tell("itself " + std::to_string(signal)) : void(kill(pid_, signal));
}

void ChildProcess::signal_tree(int signal) const {
  if (ending_) return;
  is_attended() ? tell("tree " + std::to_string(signal)) : launcher::signal_tree(pid_, signal);
}

void ChildProcess::signal_named(const std::string& name, int signal) const {
  if (ending_) return;
  is_attended() ? tell("named " + name + " " + std::to_string(signal)) : launcher::signal_named(pid_, name, signal);
}

/// A connection that is gone takes no words; the attendant ends its program then.
void ChildProcess::tell(const std::string& words) const {
  const std::string line = words + "\n";
  (void)!write(words_, line.data(), line.size());
}

std::vector<OutputLine> ChildProcess::read(int& file, OutputSplitter& lines) {
  std::vector<OutputLine> found;
  char bytes[65536];
  while (file >= 0) {
    const ssize_t n_bytes = ::read(file, bytes, sizeof bytes);
    if (n_bytes > 0) {
      for (OutputLine& line : lines.add(bytes, static_cast<std::size_t>(n_bytes))) found.push_back(std::move(line));
    } else if (n_bytes < 0 && (errno == EAGAIN || errno == EINTR)) {
      break;
    } else {  // the end; a terminal whose other end is closed says EIO
      for (OutputLine& line : lines.finish()) found.push_back(std::move(line));
      close(file);
      file = -1;
    }
  }
  return found;
}

}  // namespace couplet::launcher
