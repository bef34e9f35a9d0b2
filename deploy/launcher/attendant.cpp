#include "deploy/launcher/attendant.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <sstream>

#include "deploy/launcher/process_tree.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds before_kill(3);

[[noreturn]] void become(char* const* words, pid_t attendant, const sigset_t& signals) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != attendant) _exit(127);
  setpgid(0, 0);
  sigprocmask(SIG_SETMASK, &signals, nullptr);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  execvp(words[0], words);
  dprintf(STDERR_FILENO, "couplet: cannot start %s: %s\n", words[0], std::strerror(errno));
  _exit(127);
}

void obey(const std::string& line, pid_t program) {
  std::istringstream words(line);
  std::string whom, name;
  int signal = 0;
  words >> whom;
  if (whom == "named") words >> name;
  if (!(words >> signal) || signal <= 0 || signal >= NSIG) return;  // a line that was cut off with the connection
  if (whom == "itself") kill(program, signal);
  if (whom == "tree") signal_tree(program, signal);
  if (whom == "named") signal_named(program, name, signal);
}

/// The launcher's lines; false at their end.
bool listen(std::string& pending, pid_t program) {
  char bytes[4096];
  const ssize_t n_bytes = read(STDIN_FILENO, bytes, sizeof bytes);
  if (n_bytes <= 0) return n_bytes < 0 && (errno == EINTR || errno == EAGAIN);
  pending.append(bytes, static_cast<std::size_t>(n_bytes));
  for (std::size_t end; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1))
    obey(pending.substr(0, end), program);
  return true;
}

}  // namespace

int attend(const std::vector<std::string>& command) {
  if (command.empty()) throw report::SceneError("attend", "there is no command to start");
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGCHLD, SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, &before);
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // what its program leaves behind becomes its own
  const int signal_file = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);

  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const pid_t attendant = getpid(), program = fork();
  if (program == 0) become(words.data(), attendant, before);
  if (program < 0) throw report::FileError(command.front(), std::strerror(errno), "close other programs there");

  std::string pending;
  std::optional<Clock::time_point> ends;  // when it is killed, once the launcher is gone
  const auto part = [&] {
    if (ends) return;
    kill(program, SIGTERM);
    kill(program, SIGCONT);
    ends = Clock::now() + before_kill;
  };
  while (true) {
    pollfd files[2] = {{signal_file, POLLIN, 0}, {ends ? -1 : STDIN_FILENO, POLLIN, 0}};
    poll(files, 2, 200);
    if (files[1].revents != 0 && !listen(pending, program)) part();
    signalfd_siginfo signal;
    while (read(signal_file, &signal, sizeof signal) == sizeof signal)
      if (signal.ssi_signo != SIGCHLD) part();
    if (ends && Clock::now() > *ends) signal_tree(program, SIGKILL);
    int status = 0;
    if (waitpid(program, &status, WNOHANG) != program) continue;
    for (const ProcessState& left : process_tree(attendant))
      if (left.pid != attendant) kill(left.pid, SIGKILL);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
}

}  // namespace couplet::launcher
