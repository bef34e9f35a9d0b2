#include "deploy/launcher/checked_scene.hpp"

#include <cstdio>

#include "proto/report/failure.hpp"

namespace couplet::launcher {

scene::SceneFile read_checked_scene(const std::filesystem::path& scene, const std::vector<std::string>& settings) {
  scene::ReadResult read = scene::read_scene(scene, settings);
  if (read.complaints.empty()) return std::move(read.file);
  for (const scene::Complaint& complaint : read.complaints) std::fprintf(stderr, "%s\n", complaint.text().c_str());
  const std::size_t n_complaints = read.complaints.size();
  throw report::SceneError(
      scene.string(), n_complaints == 1 ? "one complaint, above" : std::to_string(n_complaints) + " complaints, above",
      "mend them; `couplet describe` explains every field");
}

}  // namespace couplet::launcher
