#pragma once
// One element at one quadrature point, element by element: the plain form that set-up, mass, tangent and tests use. The
// fast form is internal_force.

#include "solid-server/element/quadrature.hpp"
#include "solid-server/element/shape_functions.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// One row a node of an element.
using ElementVectors = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, max_element_nodes, 3>;

/// Rows of a node array at the nodes of an element.
template <class NodeArray>
ElementVectors at_element(const NodeArray& values, std::span<const Index> nodes) {
  ElementVectors out(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t a = 0; a < nodes.size(); ++a)
    out.row(static_cast<Eigen::Index>(a)) = values.row(nodes[a]).template head<3>();
  return out;
}

/// The reference shape of an element at a point.
struct ReferencePoint {
  Eigen::Matrix3d inverse_jacobian;              // dxi_k/dX_J, (k, J) [1/m]
  double volume = 0;                             // det(dX/dxi) times the weight [m^3]; not above 0: a folded element
  ShapeGradient<max_element_nodes, 3> gradient;  // dN_a/dX_J [1/m]
};

ReferencePoint reference_point(ElementShape shape, const ElementVectors& position, const QuadraturePoint& point);

/// A point of quadrature and dN_a/dxi_k there, found once for all elements of a block.
struct TabulatedPoint {
  double weight = 0;
  ShapeValues<max_element_nodes> value;
  ShapeGradient<max_element_nodes, 3> natural_gradient;
};
std::vector<TabulatedPoint> tabulate(ElementShape shape, const std::vector<QuadraturePoint>& points);
/// dX_J/dxi_k, (J, k) [m].
Eigen::Matrix3d jacobian(const ElementVectors& position, const TabulatedPoint& point);

/// F = I + sum_a u_a (x) dN_a/dX.
Tensor<double> deformation_gradient(const ElementVectors& displacement, const ReferencePoint& point);

}  // namespace couplet::solid
