#include "solid-server/mesh/solid_mesh.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"

namespace couplet::solid {

FaceNodes SolidMesh::nodes_of(const ElementFace& face) const {
  FaceNodes nodes{};
  const auto& element = element_node[static_cast<std::size_t>(face.element)];
  const auto& local = hex20::face_node[static_cast<std::size_t>(face.side)];
  for (std::size_t a = 0; a < nodes.size(); ++a) nodes[a] = element[static_cast<std::size_t>(local[a])];
  return nodes;
}

const std::vector<ElementFace>& SolidMesh::find_surface(const std::string& name, const std::string& where) const {
  const auto found = surface.find(name);
  if (found != surface.end()) return found->second;
  std::string names;
  for (const auto& [known, faces] : surface) names += (names.empty() ? "" : ", ") + known;
  throw report::SceneError(where, "the mesh has no surface \"" + name + "\"", "choose one of: " + names);
}

std::vector<Index> nodes_of_faces(const SolidMesh& mesh, const std::vector<ElementFace>& faces) {
  std::vector<Index> nodes;
  for (const ElementFace& face : faces) {
    const FaceNodes face_nodes = mesh.nodes_of(face);
    nodes.insert(nodes.end(), face_nodes.begin(), face_nodes.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace couplet::solid
