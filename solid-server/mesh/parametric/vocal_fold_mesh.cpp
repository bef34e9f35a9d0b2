#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/section_grid.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

void name_surfaces(const StructuredBlock& block, SolidMesh& mesh) {
  mesh.surface = {{"lateral", block.side(hex20::eta_min)},   {"inferior", block.side(hex20::xi_min)},
                  {"medial", block.side(hex20::eta_max)},    {"superior", block.side(hex20::xi_max)},
                  {"anterior", block.side(hex20::zeta_min)}, {"posterior", block.side(hex20::zeta_max)}};
}

/// The node of the three free faces that is nearest to a point.
Index nearest_free_node(const SolidMesh& mesh, const Eigen::Vector3d& point) {
  Index nearest = -1;
  double smallest = 0;
  for (const char* name : {"inferior", "medial", "superior"})
    for (const Index node : nodes_of_faces(mesh, mesh.surface.at(name))) {
      const double distance = (mesh.node_position.row(node).transpose() - point).squaredNorm();
      if (nearest < 0 || distance < smallest) nearest = node, smallest = distance;
    }
  return nearest;
}

void name_markers(const FoldSection& section, const VocalFoldShape& shape, SolidMesh& mesh) {
  const auto middle_of_arc = [](const Eigen::Vector2d& centre, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return divide_arc(centre, from, to, 2)[1];
  };
  const std::map<std::string, Eigen::Vector2d> points = {
      {"inferior_middle", middle_of_arc(section.inferior_centre, section.A, section.B1)},
      {"B1", section.B1},
      {"B2", section.B2},
      {"medial_middle", (section.B2 + section.C1) / 2},
      {"C1", section.C1},
      {"superior_fillet_middle", middle_of_arc(section.superior_fillet_centre, section.C1, section.C2)},
      {"C2", section.C2},
  };
  for (const auto& [name, point] : points)
    mesh.marker[name] = nearest_free_node(mesh, {point.x() + shape.x_offset, point.y(), shape.length / 2});
}

}  // namespace

SolidMesh make_vocal_fold_mesh(const VocalFoldShape& shape) {
  const auto [n_x, n_y, n_whole] = shape.n_elements;
  if (shape.half_length && n_whole % 2 != 0)
    throw report::SceneError("vocal_fold.elements_z",
                             std::to_string(n_whole) + " elements along the length cannot be halved",
                             "choose an even number, or leave out half_length");
  const int n_z = shape.half_length ? n_whole / 2 : n_whole;

  const FoldSection section = make_fold_section(shape.section);
  const SectionGrid grid(section, n_x, n_y);
  const StructuredBlock block(n_x, n_y, n_z);
  SolidMesh mesh = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
    const Eigen::Vector2d point = grid.at(place.i, place.j);
    return {point.x() + shape.x_offset, point.y(), shape.length * place.k / (2.0 * n_whole)};
  });
  name_surfaces(block, mesh);
  name_markers(section, shape, mesh);
  return mesh;
}

}  // namespace couplet::solid
