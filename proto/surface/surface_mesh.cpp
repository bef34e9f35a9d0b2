#include "proto/surface/surface_mesh.hpp"

#include "proto/report/failure.hpp"

namespace couplet::surface {

void check_surface(const SurfaceMesh& mesh, const std::string& whose) {
  const auto refuse = [&](const std::string& sentence) {
    throw report::PeerError(whose, "bad interface surface: " + sentence, "mend the program that offers it");
  };
  if (mesh.node_position.rows() > 0 && mesh.node_position.cols() != 3)
    refuse("node positions do not have 3 components");
  if (!mesh.node_position.allFinite()) refuse("a node position is not finite");
  const auto n_faces = mesh.n_faces();
  if (mesh.face_region.size() != n_faces)
    refuse("face_region has " + std::to_string(mesh.face_region.size()) + " entries for " + std::to_string(n_faces) +
           " faces");
  if (n_faces > 0 && (mesh.face_offset(0) != 0 || mesh.face_offset(n_faces) != mesh.face_node.size()))
    refuse("face_offset does not span face_node");
  for (std::int64_t face = 0; face < n_faces; ++face) {
    const auto count = mesh.face_offset(face + 1) - mesh.face_offset(face);
    if (count != 3 && count != 4 && count != 6 && count != 8)
      refuse("face " + std::to_string(face) + " has " + std::to_string(count) + " nodes, not 3, 4, 6 or 8");
    if (mesh.face_region(face) < 0 || mesh.face_region(face) >= static_cast<std::int64_t>(mesh.region.size()))
      refuse("face " + std::to_string(face) + " has no region");
  }
  for (const auto node : mesh.face_node) {
    if (node < 0 || node >= mesh.n_nodes())
      refuse("a face names node " + std::to_string(node) + " of " + std::to_string(mesh.n_nodes()));
  }
  for (const auto& [name, node] : mesh.marker) {
    if (node < 0 || node >= mesh.n_nodes()) refuse("marker '" + name + "' names node " + std::to_string(node));
  }
}

}  // namespace couplet::surface
