#pragma once
// A scene that may run, or every complaint about it.

#include <filesystem>
#include <string>
#include <vector>

#include "proto/scene/read_scene.hpp"

namespace couplet::launcher {

/// Reads and checks a scene. Complaints go to standard error, one a line, each beginning with file:line:column; then
/// one SceneError is thrown that counts them.
scene::SceneFile read_checked_scene(const std::filesystem::path& scene, const std::vector<std::string>& settings);

}  // namespace couplet::launcher
