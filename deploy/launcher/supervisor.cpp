#include "deploy/launcher/supervisor.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "deploy/launcher/mpi_output.hpp"
#include "deploy/launcher/process_tree.hpp"

namespace couplet::launcher {
namespace {

/// mpirun and shells report a signal as a code above 128.
bool is_loss(const Ending& end) {
  constexpr int lost_program = 4;
  return end.by_signal || end.code > 128 || end.code == lost_program;
}

}  // namespace

Supervisor::Supervisor(RunConsole& console, Patience patience) : console_(console), patience_(patience) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, &signals_before_);
  signal(SIGPIPE, SIG_IGN);          // a terminal or a connection that is gone is no reason to leave a run alone
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // a rank that outlives its mpirun becomes our child
  signal_file_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
}

Supervisor::~Supervisor() {
  programs_.clear();
  close(signal_file_);
  sigprocmask(SIG_SETMASK, &signals_before_, nullptr);
}

void Supervisor::start_server(const ProgramStart& start) {
  programs_.push_back({start.name, start.owner_of_time, ChildProcess(start, {}), false, start.is_own, {}, {}});
}

void Supervisor::start_leader(const ProgramStart& start) {
  // Behind mpirun there are pipes: there the program is told that somebody watches.
  const bool as_terminal = console_.shows_terminal() && start.name != "mpirun";
  if (console_.shows_terminal() && start.name == "mpirun") setenv("COUPLET_PROGRESS_UPDATES", "1", 1);
  programs_.push_back(
      {start.name, start.owner_of_time, ChildProcess(start, {as_terminal, as_terminal}), true, false, {}, {}});
}

std::optional<std::string> Supervisor::wait_for_address(const std::string& server) {
  const auto program =
      std::find_if(programs_.begin(), programs_.end(), [&](const auto& p) { return p.name == server; });
  const auto deadline = Clock::now() + patience_.start;
  while (program->address.empty() && ending_.endings.empty() && !ending_.stop_requested) {
    if (Clock::now() > deadline) {
      give_up(server + " did not say within " + std::to_string(static_cast<int>(patience_.start.count())) +
              " s where it listens");
      return {};
    }
    watch_once();
  }
  if (!program->address.empty()) return program->address;
  for (const Program& other : programs_) {
    const auto& end = other.process.ending();
    if (other.address.empty() && end && !end->by_signal && end->code == 0 && !ending_.stop_requested)
      give_up(other.name + " ended before it said where it listens, by a line `listening ADDRESS`");
  }
  return std::nullopt;
}

RunEnding Supervisor::run_to_end() {
  while (any_running()) {
    watch_once();
    note_frozen();
    end_survivors();
  }
  kill_orphans();
  return ending_;
}

RunEnding Supervisor::end_all() {
  hurry();
  return run_to_end();
}

void Supervisor::watch_once() {
  wait_for_news();
  read_signals();
  for (Program& program : programs_) read_lines(program);
  note_endings();
}

void Supervisor::wait_for_news() const {
  std::vector<pollfd> files{{signal_file_, POLLIN, 0}};
  for (const Program& program : programs_) {
    for (const int file : {program.process.output(), program.process.errors()}) {
      if (file >= 0) files.push_back({file, POLLIN, 0});
    }
  }
  poll(files.data(), files.size(), 200);
}

void Supervisor::read_signals() {
  signalfd_siginfo signal;
  while (read(signal_file_, &signal, sizeof signal) == sizeof signal) {
    if (signal.ssi_signo != SIGCHLD) pass_on_stop_request();
  }
}

/// The program that owns time ends in good order after its step; asked again, all are told to end at once.
void Supervisor::pass_on_stop_request() {
  if (ending_.stop_requested) return hurry();
  ending_.stop_requested = true;
  console_.show("stopping in good order; once more to stop at once");
  console_.log("couplet", "asked to stop");
  const auto leader = std::find_if(programs_.begin(), programs_.end(), [](const Program& p) { return p.is_leader; });
  if (leader == programs_.end() || !leader->process.is_running()) return hurry();
  if (leader->name != "mpirun") return leader->process.send_signal(SIGTERM);
  leader->process.signal_named(leader->owner_of_time, SIGTERM);
}

void Supervisor::read_lines(Program& program) {
  for (OutputLine& line : program.process.read_output()) hear(program, std::move(line), false);
  for (OutputLine& line : program.process.read_errors()) hear(program, std::move(line), true);
}

void Supervisor::hear(Program& program, OutputLine line, bool is_error) {
  std::string speaker = program.name;
  if (speaker == "mpirun") speaker = line.is_update ? take_mpi_tags(line.text) : take_mpi_tag(line.text);
  const bool is_for_user = program.is_leader && (speaker == program.name || speaker == "rank 0");
  if (line.is_update) {
    if (is_for_user && !line.text.empty()) console_.update(line.text);
    if (is_for_user && line.ends_line) console_.end_update();
    return;
  }
  if (line.text.empty()) return;
  console_.log(speaker, line.text);
  const std::string greeting = "listening ";
  if (!is_error && line.text.starts_with(greeting)) program.address = line.text.substr(greeting.size());
  if (program.is_own) {
    if (is_error) program.last_words = line.text;
    return;
  }
  if (is_last_word(line.text)) {
    // Said at the end of the run, after everything else. Of an MPI job the coupler's word counts.
    if (program.last_words.empty() || speaker == program.name || speaker == "rank 0") program.last_words = line.text;
  } else if (is_for_user && speaker != "mpirun") {
    console_.show(line.text);
  }
}

void Supervisor::note_endings() {
  for (Program& program : programs_) {
    if (!program.process.is_running()) continue;
    program.process.look();
    if (program.process.is_running()) continue;
    read_lines(program);
    const Ending end = *program.process.ending();
    ending_.endings.push_back(
        {program.name, end, program.is_leader, program.was_asked, program.last_words, program.is_own});
    console_.log("couplet", program.name + (end.by_signal ? " was ended by signal " : " ended with code ") +
                                std::to_string(end.code));
    if (program.is_leader || end.by_signal || end.code != 0) first_loss_ = first_loss_.value_or(Clock::now());
    if (is_loss(end) && !ending_.stop_requested) drop_if_replaced();
  }
}

void Supervisor::note_frozen() {
  const auto now = Clock::now();
  if (now - last_frozen_look_ < std::chrono::milliseconds(500)) return;
  last_frozen_look_ = now;
  std::map<pid_t, Clock::time_point> still_frozen;
  for (const Program& program : programs_) {
    if (!program.process.is_running()) continue;
    // Of another host nothing is known here: there a frozen program is found by its peers.
    for (const ProcessState& process : process_tree(program.process.pid())) {
      if (!process.is_frozen) continue;
      const auto known = frozen_since_.find(process.pid);
      const auto since = known == frozen_since_.end() ? now : known->second;
      still_frozen[process.pid] = since;
      if (now - since > patience_.frozen) give_up(process.name + " was stopped by a signal and did not continue");
    }
  }
  frozen_since_ = std::move(still_frozen);
}

void Supervisor::give_up(const std::string& why) {
  if (ending_.stuck.empty()) console_.log("couplet", why);
  if (ending_.stuck.empty()) ending_.stuck = why;
  first_loss_ = first_loss_.value_or(Clock::now());
  drop_if_replaced();
}

/// Who is started again from what lies on the disk need not end in good order.
void Supervisor::drop_if_replaced() {
  if (patience_.is_replaced) first_loss_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(patience_.kill);
}

void Supervisor::hurry() {
  first_loss_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(patience_.ask);
}

void Supervisor::end_survivors() {
  if (!first_loss_ || !any_running()) return;
  const auto waited = Clock::now() - *first_loss_;
  if (waited > patience_.ask && !were_asked_) {
    were_asked_ = true;
    signal_all(SIGTERM);
    signal_all(SIGCONT);  // a frozen program hears only then
  }
  if (waited > patience_.kill && !were_killed_) {
    were_killed_ = true;
    signal_all(SIGKILL);
  }
}

void Supervisor::signal_all(int signal) {
  for (Program& program : programs_) {
    if (!program.process.is_running()) continue;
    program.was_asked = true;
    // What mpirun is asked to end it ends in good order itself.
    signal == SIGTERM ? program.process.send_signal(signal) : program.process.signal_tree(signal);
  }
}

/// What was left by a program that has ended, for example a frozen rank by its mpirun.
void Supervisor::kill_orphans() {
  for (const ProcessState& process : process_tree(getpid())) {
    if (process.pid == getpid()) continue;
    kill(process.pid, SIGKILL);
    waitpid(process.pid, nullptr, 0);
  }
}

bool Supervisor::any_running() const {
  return std::any_of(programs_.begin(), programs_.end(), [](const Program& p) { return p.process.is_running(); });
}

}  // namespace couplet::launcher
