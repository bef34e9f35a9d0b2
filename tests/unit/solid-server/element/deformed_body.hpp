#pragma once
// Displacements that tests of elements give to a mesh, and the forces that answer them.

#include <gtest/gtest.h>

#include <cmath>

#include "solid-server/dynamics/nodal_force.hpp"

namespace couplet::solid {

struct Forces {
  NodeVectors at_node;
  double energy = 0;
};

inline Forces forces(const SolidMesh& mesh, const BlockProperties& properties, const NodeVectors& displacement) {
  NodalForce body(mesh, {properties}, ExternalForce(mesh, {}, {}, {}), 1);
  const NodeVectors at_node = body.all(displacement, {0, 0, true});
  EXPECT_EQ(body.inverted_element(), -1);
  return {at_node, body.strain_energy()};
}

/// x = F X.
inline NodeVectors homogeneous(const SolidMesh& mesh, const Eigen::Matrix3d& F) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  displacement.leftCols<3>() = mesh.node_position * (F - Eigen::Matrix3d::Identity()).transpose();
  return displacement;
}

inline NodeVectors wavy(const SolidMesh& mesh) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d X = mesh.node_position.row(n);
    displacement.row(n) << 0.1 * std::sin(X.y() + X.z()), 0.08 * X.x() * std::cos(X.z()), 0.05 * X.x() * X.y(), 0;
  }
  return displacement;
}

inline const Eigen::Matrix3d stretched{{1.2, 0.3, -0.1}, {0.05, 0.85, 0.2}, {-0.15, 0.1, 1.1}};

/// In a homogeneous state no inner node feels a force: the largest one, over the pressure-wave modulus times an
/// element's area.
inline double patch_error(const SolidMesh& mesh, const BlockProperties& properties) {
  const NodeVectors force = forces(mesh, properties, homogeneous(mesh, stretched)).at_node;
  std::vector<char> is_outside(static_cast<std::size_t>(mesh.n_nodes()), 0);
  for (const auto& [name, faces] : mesh.surface)
    for (const Index n : nodes_of_faces(mesh, faces)) is_outside[static_cast<std::size_t>(n)] = 1;
  double largest = 0;
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (!is_outside[static_cast<std::size_t>(n)]) largest = std::max(largest, force.row(n).cwiseAbs().maxCoeff());
  return largest / std::visit([](const auto& law) { return law.pressure_wave_modulus(); }, properties.material);
}

}  // namespace couplet::solid
