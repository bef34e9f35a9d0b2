#include "proto/scene/read_scene.hpp"

#include "proto/report/failure.hpp"
#include "proto/scene/apply_setting.hpp"
#include "proto/scene/check_scene.hpp"
#include "proto/scene/message_parser.hpp"
#include "proto/scene/read_text.hpp"
#include "proto/scene/relation_rules.hpp"

namespace couplet::scene {

ReadResult read_scene_text(const std::string& text, const std::filesystem::path& path,
                           const std::vector<std::string>& settings) {
  ReadResult result{{{}, path, path.parent_path()}, {}};
  v1::Scene& scene = result.file.scene;
  ComplaintList complaints(path.string());
  if (text.find('\0') != std::string::npos) {
    complaints.add({}, "", "this is not a text file; give a scene such as scene.txtpb");
    result.complaints = complaints.in_order();
    return result;
  }
  FieldTree tree;
  bool braces_match = MessageParser(text, "", complaints).parse_all(scene, tree);
  for (const std::string& setting : settings) braces_match &= apply_setting(setting, scene, tree, complaints);
  Review review(tree, braces_match, complaints);
  check_fields(scene, result.file.folder, review);
  check_relations(scene, review);
  result.complaints = complaints.in_order();
  return result;
}

ReadResult read_scene(const std::filesystem::path& path, const std::vector<std::string>& settings) {
  return read_scene_text(read_text(path, "give the path of a scene, a text file such as scene.txtpb"), path, settings);
}

SceneFile load_scene(const std::filesystem::path& path, const std::vector<std::string>& settings) {
  ReadResult result = read_scene(path, settings);
  if (result.complaints.empty()) return std::move(result.file);
  std::string lines;
  for (const Complaint& complaint : result.complaints) {
    if (!lines.empty()) lines += '\n';
    lines += complaint.text();
  }
  throw report::SceneError("", lines);
}

}  // namespace couplet::scene
