#pragma once
// The verb `attend`: stands beside a program on another host for the launcher, which reaches it by a remote shell only.

#include <string>
#include <vector>

namespace couplet::launcher {

/// Starts the command and does what standard input says, a line each:
///   itself NUMBER        sends the signal to the program
///   tree NUMBER          to it and all that descends from it
///   named NAME NUMBER    to those of them that have this name
/// When standard input ends, so does the program: it is asked to, and killed after three seconds. Nothing that it
/// started outlives it. Returns its exit code, 128 + the signal that ended it.
int attend(const std::vector<std::string>& command);

}  // namespace couplet::launcher
