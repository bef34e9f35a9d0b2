#pragma once
// Text to a checked scene, with every complaint at its place.

#include <filesystem>
#include <string>
#include <vector>

#include "couplet/v1/scene.pb.h"
#include "proto/scene/complaint.hpp"

namespace couplet::scene {

struct SceneFile {
  v1::Scene scene;
  std::filesystem::path path;
  std::filesystem::path folder;  // relative paths in the scene start here
};

struct ReadResult {
  SceneFile file;
  std::vector<Complaint> complaints;  // empty: the scene may run
};

/// Reads the file, applies the settings ("PATH=VALUE") in order, checks everything, reports all complaints at once.
/// Throws FileError when the file cannot be read.
ReadResult read_scene(const std::filesystem::path& path, const std::vector<std::string>& settings);

/// The same from text, for servers that receive a scene and for tests.
ReadResult read_scene_text(const std::string& text, const std::filesystem::path& path,
                           const std::vector<std::string>& settings);

/// read_scene for a program: throws one SceneError that holds every complaint, a line each.
SceneFile load_scene(const std::filesystem::path& path, const std::vector<std::string>& settings);

/// The scene as text with all defaults filled in and a comment on top.
std::string resolved_scene_text(const v1::Scene& scene);

}  // namespace couplet::scene
