#include "solid-server/element/formulation.hpp"

#include <algorithm>
#include <map>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr double straight_to = 0.05;  // of the edge's length

/// The corners of a face of an element, rising.
std::array<Index, 4> corners_of(const ElementTopology& t, std::span<const Index> nodes, std::size_t face) {
  std::array<Index, 4> corners{};
  for (std::size_t c = 0; c < 4; ++c) corners[c] = nodes[static_cast<std::size_t>(t.face_node[face][c])];
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

ElementFormulation default_formulation(ElementShape shape) {
  return shape == ElementShape::hexahedron8 ? ElementFormulation::stabilised : ElementFormulation::standard;
}

int default_n_points(const SolidMesh& mesh, const ElementBlock& block, ElementFormulation formulation) {
  switch (block.shape) {
    case ElementShape::hexahedron20:
      return has_curved_edges(mesh, block) ? 27 : has_single_rows(mesh, block) ? 14 : 8;
    case ElementShape::hexahedron8:
      return formulation == ElementFormulation::stabilised ? 1 : 8;
    case ElementShape::tetrahedron10:
      return 4;
  }
  __builtin_unreachable();
}

bool has_curved_edges(const SolidMesh& mesh, const ElementBlock& block) {
  const ElementTopology& t = topology(block.shape);
  const int n_edges = t.n_nodes - t.n_corners;  // those with a midside node, in the order of these nodes
  for (Index element = 0; element < block.n_elements(); ++element) {
    const auto nodes = block.nodes_of(element);
    const auto position = [&](int a) { return mesh.node_position.row(nodes[static_cast<std::size_t>(a)]); };
    for (int e = 0; e < n_edges; ++e) {
      const auto& [low, high] = t.edge[static_cast<std::size_t>(e)];
      const Eigen::RowVector3d off = position(t.n_corners + e) - (position(low) + position(high)) / 2;
      if (off.norm() > straight_to * (position(high) - position(low)).norm()) return true;
    }
  }
  return false;
}

bool has_single_rows(const SolidMesh& mesh, const ElementBlock& block) {
  const ElementTopology& t = topology(block.shape);
  if (t.n_face_corners != 4) return false;
  std::map<std::array<Index, 4>, int> n_elements_at;  // of all blocks
  for (const ElementBlock& any : mesh.block) {
    const ElementTopology& other = topology(any.shape);
    for (Index element = 0; other.n_face_corners == 4 && element < any.n_elements(); ++element)
      for (std::size_t face = 0; face < 6; ++face) ++n_elements_at[corners_of(other, any.nodes_of(element), face)];
  }
  for (Index element = 0; element < block.n_elements(); ++element) {
    int n_directions = 0;  // with a neighbour; faces 2 k and 2 k + 1 are opposite
    for (std::size_t k = 0; k < 3; ++k)
      n_directions += n_elements_at[corners_of(t, block.nodes_of(element), 2 * k)] > 1 ||
                      n_elements_at[corners_of(t, block.nodes_of(element), 2 * k + 1)] > 1;
    if (n_directions < 2) return true;
  }
  return false;
}

void check_formulation(const std::string& where, ElementShape shape, ElementFormulation formulation,
                       const Material& material) {
  if (formulation == ElementFormulation::standard) return;
  const std::string name = topology(shape).name;
  if (formulation == ElementFormulation::stabilised) {
    if (shape != ElementShape::hexahedron8)
      throw report::SceneError(where, "the stabilised formulation is one of hexahedron8, not of " + name,
                               "leave the formulation out or choose near_incompressible");
    return;
  }
  if (shape == ElementShape::hexahedron8)
    throw report::SceneError(where, "there is no near-incompressible formulation of hexahedron8",
                             "leave the formulation out: the stabilised one does not lock when the volume is kept");
  if (!std::visit([](const auto& law) { return law.has_volumetric_part; }, material))
    throw report::SceneError(where,
                             "the near-incompressible formulation needs a law with a part of its own for the volume, "
                             "which Saint Venant-Kirchhoff has not",
                             "choose neo_hookean or mooney_rivlin with the bulk modulus E/(3 (1 - 2 nu))");
}

}  // namespace couplet::solid
