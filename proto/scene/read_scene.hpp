#pragma once
// Text to a checked scene, with every complaint at its place.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "couplet/v1/scene.pb.h"

namespace couplet::scene {

/// A complaint about one field: `scene.txtpb:14:9: solid.body[0].material.density: -1 is not above 0; ...`
struct Complaint {
  std::string file;
  int line = 0;  // 1, 2, ...; 0: not in the file (given by --set, or missing altogether)
  int column = 0;
  std::string field;  // path in the scene
  std::string sentence;

  std::string text() const;
};

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
