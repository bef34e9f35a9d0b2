#pragma once
// A program of the user's own that takes the place of a server.

#include <map>
#include <string>
#include <vector>

#include "deploy/launcher/installation.hpp"

namespace couplet::launcher {

/// The words of a command, split as a shell does, with quotes and variables. `option` is what the user gave it to, for
/// messages. Throws SceneError when it is no command or when there is no such program.
std::vector<std::string> split_command(const std::string& option, const std::string& command);

/// What is added to its environment: a Python program finds the module couplet_participant.
std::map<std::string, std::string> own_program_environment(const Installation& installation);

}  // namespace couplet::launcher
