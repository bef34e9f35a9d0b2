#pragma once
// The path of a field: names with dots between them, an index in brackets for an entry of a list.

#include <optional>
#include <string>
#include <vector>

namespace couplet::scene {

struct PathStep {
  std::string name;
  std::optional<int> index;
  std::string text() const;
};

/// solid.body[0].name -> {solid}, {body, 0}, {name}. Throws SceneError with the part that is not understood.
std::vector<PathStep> split_path(const std::string& path);

}  // namespace couplet::scene
