#pragma once
// Watches the programs of a run: reads what they say, passes on the user's wish to stop, and sees to it that all of
// them end when one is lost.

#include <signal.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "deploy/launcher/child_process.hpp"
#include "deploy/launcher/run_console.hpp"
#include "deploy/launcher/run_ending.hpp"

namespace couplet::launcher {

/// How long the others may take to end by themselves once a program is lost.
struct Patience {
  std::chrono::duration<double> start{30};  // until a server says where it listens
  std::chrono::duration<double> frozen{8};  // a program that is stopped for so long is given up
  std::chrono::duration<double> ask{3};     // then the others are asked to end
  std::chrono::duration<double> kill{8};    // then they are killed
  bool is_replaced = false;                 // what is lost is started again: the others are killed at once
};

class Supervisor {
 public:
  Supervisor(RunConsole& console, Patience patience);
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void start_server(const ProgramStart& start);
  /// The end of the leader is the end of the run; its lines are shown to the user.
  void start_leader(const ProgramStart& start);
  /// What a server said after `listening`; nothing when any program ended or the user wants to stop first.
  std::optional<std::string> wait_for_address(const std::string& server);
  /// Returns when no program runs any more.
  RunEnding run_to_end();
  /// The same after telling all to end now.
  RunEnding end_all();

 private:
  using Clock = std::chrono::steady_clock;

  struct Program {
    std::string name;
    std::string owner_of_time;
    ChildProcess process;
    bool is_leader;
    bool is_own;
    std::string address;
    std::string last_words;
    bool was_asked = false;
  };

  void watch_once();
  void wait_for_news() const;
  void read_signals();
  void read_lines(Program& program);
  void hear(Program& program, OutputLine line, bool is_error);
  void note_endings();
  void note_frozen();
  void end_survivors();
  void pass_on_stop_request();
  void signal_all(int signal);
  void hurry();
  void drop_if_replaced();
  void give_up(const std::string& why);
  static void kill_orphans();
  bool any_running() const;

  RunConsole& console_;
  Patience patience_;
  int signal_file_ = -1;
  sigset_t signals_before_{};
  std::vector<Program> programs_;
  RunEnding ending_;
  std::map<pid_t, Clock::time_point> frozen_since_;
  Clock::time_point last_frozen_look_{};
  std::optional<Clock::time_point> first_loss_;  // when the end of all began
  bool were_asked_ = false, were_killed_ = false;
};

}  // namespace couplet::launcher
