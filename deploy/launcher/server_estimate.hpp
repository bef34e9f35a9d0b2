#pragma once
// What a server says that a run of a scene would need.

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/launcher/installation.hpp"

namespace couplet::launcher {

struct Estimate {
  std::string program, name, unit;
  double value = 0;
  std::string text = {};  // in place of the number; empty: none
};

/// Asks `PROGRAM check`. Throws SceneError when the program cannot tell.
std::vector<Estimate> ask_for_estimate(const std::string& program, const std::filesystem::path& scene,
                                       const std::vector<std::string>& settings, const Installation& installation);

}  // namespace couplet::launcher
