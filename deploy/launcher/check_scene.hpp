#pragma once
// The verb `check`: every complaint about a scene, or what a run of it would take.

#include <filesystem>
#include <string>
#include <vector>

namespace couplet::launcher {

/// Prints what would be launched, with cells, degrees of freedom, memory, time-step limits and cost. Throws SceneError
/// after printing every complaint when the scene may not run.
void check_scene(const std::filesystem::path& scene, const std::vector<std::string>& settings);

}  // namespace couplet::launcher
