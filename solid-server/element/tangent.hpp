#pragma once
// The stiffness of one element, for modal and static analysis.

#include "solid-server/element/deformation.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

/// One element of the standard formulation.
struct PlainElement {
  const Material& material;
  ElementShape shape;
  int n_points;
  ElementVectors position;      // at rest [m]
  LocalAxes<double> axes = {};  // of fibres at rest; isotropic laws have none
};

using ElementTangent = Eigen::MatrixXd;  // (3 n_nodes, 3 n_nodes)

/// K_(a i)(b k) = sum over points of dN_a/dX_J (d2W/dF_iJ dF_kL) dN_b/dX_L dV [N/m]; row 3 a + i. Displacement [m].
ElementTangent element_tangent(const PlainElement& element, const ElementVectors& displacement);

/// Energy [J] and minus its derivative by the displacement [N], point by point: what the fast kernel is tested against.
double element_energy(const PlainElement& element, const ElementVectors& displacement);
ElementVectors element_force(const PlainElement& element, const ElementVectors& displacement);

}  // namespace couplet::solid
