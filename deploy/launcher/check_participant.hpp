#pragma once
// The verb `check-participant`: does a program keep to the protocol?

#include <filesystem>
#include <string>
#include <vector>

namespace couplet::launcher {

struct ParticipantCheckOptions {
  std::string command;                // the program and its options
  std::filesystem::path scene;        // that is opened; empty: a small one of Couplet's own
  std::vector<std::string> settings;  // PATH=VALUE for it
  std::vector<std::string> rules;     // only rules that hold one of these texts; empty: all
};

/// Goes on as the script that looks at every rule. Throws SceneError when command or scene are wrong.
[[noreturn]] void check_participant(const ParticipantCheckOptions& options);

}  // namespace couplet::launcher
