#pragma once
// Boxes of every kind of element: made of 20-node hexahedra, whose corners or cuts give the others.

#include <algorithm>
#include <map>

#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {

/// Six tetrahedra of a hexahedron around its diagonal 0-6; neighbours of the same orientation fit.
constexpr int tetrahedra_of_hexahedron[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                                {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

/// Midside nodes to the middle of their edges.
inline void straighten_edges(SolidMesh& mesh) {
  for (const ElementBlock& block : mesh.block) {
    const ElementTopology& t = topology(block.shape);
    for (Index e = 0; e < block.n_elements(); ++e) {
      const auto nodes = block.nodes_of(e);
      for (int m = t.n_corners; m < t.n_nodes; ++m) {
        const auto& [low, high] = t.edge[static_cast<std::size_t>(m - t.n_corners)];
        mesh.node_position.row(nodes[static_cast<std::size_t>(m)]) =
            (mesh.node_position.row(nodes[static_cast<std::size_t>(low)]) +
             mesh.node_position.row(nodes[static_cast<std::size_t>(high)])) /
            2;
      }
    }
  }
}

/// The same body in elements of another shape, with straight edges; surfaces keep their names. `mesh` is one block of
/// 20-node hexahedra.
inline SolidMesh in_shape(const SolidMesh& mesh, ElementShape shape) {
  if (shape == ElementShape::hexahedron20) return mesh;
  const ElementTopology& t = topology(shape);
  SolidMesh out;
  ElementBlock& block = out.block.emplace_back();
  block.shape = shape;
  std::map<std::pair<Index, Index>, Index> known;  // a corner, or the middle between two
  std::vector<Eigen::RowVector3d> position;
  const auto node = [&](Index a, Index b) {
    const auto [place, is_new] = known.try_emplace(std::minmax(a, b), static_cast<Index>(position.size()));
    if (is_new) position.push_back((mesh.node_position.row(a) + mesh.node_position.row(b)) / 2);
    block.node.push_back(place->second);
  };
  const int n_parts = shape == ElementShape::tetrahedron10 ? 6 : 1;
  for (Index e = 0; e < mesh.n_elements(); ++e)
    for (int part = 0; part < n_parts; ++part) {
      const auto nodes = mesh.nodes_of(e);
      const auto corner = [&](int c) {
        return nodes[static_cast<std::size_t>(n_parts == 6 ? tetrahedra_of_hexahedron[part][c] : c)];
      };
      for (int c = 0; c < t.n_corners; ++c) node(corner(c), corner(c));
      for (int m = t.n_corners; m < t.n_nodes; ++m) {
        const auto& [low, high] = t.edge[static_cast<std::size_t>(m - t.n_corners)];
        node(corner(low), corner(high));
      }
    }
  out.node_position.resize(static_cast<Eigen::Index>(position.size()), 3);
  for (std::size_t n = 0; n < position.size(); ++n) out.node_position.row(static_cast<Eigen::Index>(n)) = position[n];

  for (const auto& [name, faces] : mesh.surface)
    for (const ElementFace& face : faces) {
      std::vector<Index> corners;
      const FaceNodes old_face = mesh.nodes_of(face);
      for (std::size_t c = 0; c < 4; ++c) corners.push_back(known.at({old_face[c], old_face[c]}));
      for (int part = 0; part < n_parts; ++part)
        for (int side = 0; side < t.n_faces; ++side) {
          const ElementFace candidate{face.element * n_parts + part, side};
          const FaceNodes nodes = out.nodes_of(candidate);
          const auto is_corner = [&](Index n) { return std::count(corners.begin(), corners.end(), n) > 0; };
          if (std::all_of(nodes.begin(), nodes.begin() + t.n_face_corners, is_corner))
            out.surface[name].push_back(candidate);
        }
    }
  return out;
}

/// 3 x 2 x 3 parallelepipeds whose inner corners are moved: no edge is parallel to another, all are straight.
inline SolidMesh distorted_patch_of(ElementShape shape) {
  SolidMesh mesh = make_box_mesh({{3, 2, 3}, {3, 2, 3}});
  const NodePositions rest = mesh.node_position;
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    Eigen::RowVector3d X = rest.row(n);
    const bool is_inside = X[0] > 0.1 && X[0] < 2.9 && X[1] > 0.1 && X[1] < 1.9 && X[2] > 0.1 && X[2] < 2.9;
    if (is_inside) X += 0.15 * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
    mesh.node_position.row(n) << X[0] + 0.3 * X[1], X[1] - 0.2 * X[2], 0.9 * X[2] + 0.1 * X[0];
  }
  straighten_edges(mesh);
  return in_shape(mesh, shape);
}

/// Moves midside nodes inside the patch off the middle of their edges, by some `offset` [m].
inline SolidMesh curved_patch_of(ElementShape shape, double offset) {
  SolidMesh mesh = distorted_patch_of(shape);
  std::vector<char> is_kept(static_cast<std::size_t>(mesh.n_nodes()), 0);
  const auto keep = [&](Index n) { is_kept[static_cast<std::size_t>(n)] = 1; };
  const ElementTopology& t = topology(shape);
  for (Index e = 0; e < mesh.n_elements(); ++e)
    for (const Index n : mesh.nodes_of(e).first(static_cast<std::size_t>(t.n_corners))) keep(n);
  for (const auto& [name, faces] : mesh.surface)
    for (const Index n : nodes_of_faces(mesh, faces)) keep(n);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (!is_kept[static_cast<std::size_t>(n)])
      mesh.node_position.row(n) += offset * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
  return mesh;
}

}  // namespace couplet::solid
