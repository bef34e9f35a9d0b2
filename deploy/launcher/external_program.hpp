#pragma once
// Programs that the launcher runs beside a run: scripts, benchmarks, estimates.

#include <string>
#include <vector>

namespace couplet::launcher {

struct ProgramResult {
  int exit_code = 0;
  std::string output;
  std::string errors;
};

/// Runs a program to its end and catches what it says. Throws FileError when it cannot be started.
ProgramResult run_and_catch(const std::vector<std::string>& command);

/// Goes on as another program, with the same terminal. Throws FileError when that is impossible.
[[noreturn]] void become_program(const std::vector<std::string>& command);

}  // namespace couplet::launcher
