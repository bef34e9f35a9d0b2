#pragma once
// How the programs of a run ended, and what that means for its exit code.

#include <string>
#include <vector>

#include "deploy/launcher/child_process.hpp"

namespace couplet::launcher {

struct ProgramEnding {
  std::string program;
  Ending ending;
  bool is_leader = false;
  bool was_asked = false;  // the launcher had told it to end before
  std::string last_words;  // its last line on standard error
  bool is_own = false;     // a program of the user's own
};

struct RunEnding {
  std::vector<ProgramEnding> endings;  // in order of time
  std::string stuck;                   // what did not move any more and was given up, in words; empty: nothing
  bool stop_requested = false;         // by the user
};

struct Verdict {
  int exit_code = 0;
  std::string sentence;  // the last line of a run that failed
  bool is_loss = false;  // of a program or a connection: the same again may go well
};

/// The exit code of the run and the line that explains it. A program that was killed explains what the others complain
/// about; a program that reports its own failure comes before those that merely lost it.
Verdict judge(const RunEnding& run);

}  // namespace couplet::launcher
