#pragma once
// Shape functions of every kind of element and face, one point at a time: for set-up, mass, contact and tests.

#include <Eigen/Core>

#include "solid-server/mesh/element_shape.hpp"

namespace couplet::solid {

template <int rows_max>
using ShapeValues = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, rows_max, 1>;
template <int rows_max, int n_axes>
using ShapeGradient = Eigen::Matrix<double, Eigen::Dynamic, n_axes, Eigen::ColMajor, rows_max, n_axes>;

/// N_a(xi), (n_nodes). Hexahedra on [-1, 1]^3, tetrahedra on xi, eta, zeta >= 0, xi + eta + zeta <= 1   [Zienkiewicz,
/// Taylor, Zhu 2005, 4.9 to 4.11].
ShapeValues<max_element_nodes> shape_values(ElementShape shape, const Eigen::Vector3d& xi);
/// dN_a/dxi_k, (n_nodes, 3).
ShapeGradient<max_element_nodes, 3> shape_gradient(ElementShape shape, const Eigen::Vector3d& xi);

/// The same for faces: quadrilaterals on [-1, 1]^2, triangles on xi, eta >= 0, xi + eta <= 1.
ShapeValues<max_face_nodes> shape_values(FaceShape shape, const Eigen::Vector2d& xi);
ShapeGradient<max_face_nodes, 2> shape_gradient(FaceShape shape, const Eigen::Vector2d& xi);

}  // namespace couplet::solid
