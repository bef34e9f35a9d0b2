#pragma once
// One element at one quadrature point, element by element: the plain form that set-up, mass, tangent and tests use. The
// fast form is internal_force.

#include "solid-server/element/quadrature.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

using ElementVectors = Eigen::Matrix<double, hex20::n_nodes, 3>;  // one row a node of an element

/// Rows of a node array at the nodes of an element.
template <class NodeArray>
ElementVectors at_element(const NodeArray& values, const std::array<Index, hex20::n_nodes>& nodes) {
  ElementVectors out;
  for (int a = 0; a < hex20::n_nodes; ++a)
    out.row(a) = values.row(nodes[static_cast<std::size_t>(a)]).template head<3>();
  return out;
}

/// The reference shape of an element at a point.
struct ReferencePoint {
  Eigen::Matrix3d inverse_jacobian;  // dxi_k/dX_J, (k, J) [1/m]
  double volume = 0;                 // det(dX/dxi) times the weight [m^3]; not above 0: a folded element
  Eigen::Matrix<double, hex20::n_nodes, 3> gradient;  // dN_a/dX_J [1/m]
};

ReferencePoint reference_point(const ElementVectors& position, const QuadraturePoint& point);

/// F = I + sum_a u_a (x) dN_a/dX.
Tensor<double> deformation_gradient(const ElementVectors& displacement, const ReferencePoint& point);

}  // namespace couplet::solid
