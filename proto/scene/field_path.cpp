#include "proto/scene/field_path.hpp"

#include <regex>

#include "proto/report/failure.hpp"

namespace couplet::scene {

std::string PathStep::text() const {
  return index ? name + "[" + std::to_string(*index) + "]" : name;
}

std::vector<PathStep> split_path(const std::string& path) {
  static const std::regex step_pattern(R"(([A-Za-z_][A-Za-z0-9_]*)(?:\[([0-9]{1,9})\])?)");
  std::vector<PathStep> steps;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find('.', start), path.size());
    const std::string part = path.substr(start, end - start);
    std::smatch match;
    if (part.size() > 200 || !std::regex_match(part, match, step_pattern)) {
      throw report::SceneError("", "\"" + part + "\" is not a field of a path",
                               "write paths like solid.body[0].material.density");
    }
    PathStep step{match[1], std::nullopt};
    if (match[2].matched) step.index = std::stoi(match[2]);
    steps.push_back(step);
    start = end + 1;
  }
  return steps;
}

}  // namespace couplet::scene
