#pragma once
// Shape functions of the 20-node serendipity hexahedron and of its 8-node faces.

#include <Eigen/Core>

#include "solid-server/mesh/hex20_topology.hpp"

namespace couplet::solid::hex20 {

/// N_a(xi): corners 1/8 (1+xi xi_a)(1+eta eta_a)(1+zeta zeta_a)(xi xi_a + eta eta_a + zeta zeta_a - 2); midside nodes
/// with xi_a = 0: 1/4 (1-xi^2)(1+eta eta_a)(1+zeta zeta_a), and so on   [Zienkiewicz, Taylor, Zhu 2005, 4.9].
Eigen::Matrix<double, n_nodes, 1> shape(const Eigen::Vector3d& xi);

/// dN_a/dxi_k, (n_nodes, 3).
Eigen::Matrix<double, n_nodes, 3> shape_gradient(const Eigen::Vector3d& xi);

/// The same for a face at (xi, eta), nodes in the order of face_node.
Eigen::Matrix<double, n_face_nodes, 1> face_shape(const Eigen::Vector2d& xi);
Eigen::Matrix<double, n_face_nodes, 2> face_shape_gradient(const Eigen::Vector2d& xi);

}  // namespace couplet::solid::hex20
