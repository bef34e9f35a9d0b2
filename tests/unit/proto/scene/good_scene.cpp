#include "tests/unit/proto/scene/good_scene.hpp"

#include <stdexcept>

#include "proto/scene/read_scene.hpp"

namespace couplet::scene {

std::string with(const std::string& part, const std::string& replacement, const std::string& scene) {
  const std::size_t place = scene.find(part);
  if (place == std::string::npos || scene.find(part, place + 1) != std::string::npos) {
    throw std::logic_error("the scene does not hold exactly once: " + part);
  }
  std::string text = scene;
  return text.replace(place, part.size(), replacement);
}

std::vector<std::string> complaints_about(const std::string& text, const std::vector<std::string>& settings) {
  std::vector<std::string> lines;
  for (const Complaint& complaint : read_scene_text(text, "scene.txtpb", settings).complaints) {
    lines.push_back(complaint.text());
  }
  return lines;
}

}  // namespace couplet::scene
