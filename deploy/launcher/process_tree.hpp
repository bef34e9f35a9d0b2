#pragma once
// What /proc says about processes that were started by those the launcher started.

#include <sys/types.h>

#include <string>
#include <vector>

namespace couplet::launcher {

struct ProcessState {
  pid_t pid = 0;
  std::string name;        // of the program, first 15 characters
  bool is_frozen = false;  // stopped by a signal or held by a debugger
};

/// The process itself and all that descend from it; none when it has ended.
std::vector<ProcessState> process_tree(pid_t root);

/// Sends a signal to all of them.
void signal_tree(pid_t root, int signal);
/// To those of them that have this name.
void signal_named(pid_t root, const std::string& name, int signal);

}  // namespace couplet::launcher
