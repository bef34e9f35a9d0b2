#pragma once
// The stiffness of one element, for modal and static analysis.

#include "solid-server/element/deformation.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

using ElementTangent = Eigen::Matrix<double, 3 * hex20::n_nodes, 3 * hex20::n_nodes>;

/// K_(a i)(b k) = sum over points of dN_a/dX_J (d2W/dF_iJ dF_kL) dN_b/dX_L dV [N/m]; row 3 a + i. Displacement [m].
ElementTangent element_tangent(const Material& material, const ElementVectors& position,
                               const ElementVectors& displacement, int n_points);

/// Energy [J] and minus its derivative by the displacement [N], point by point: what the fast kernel is tested against.
double element_energy(const Material& material, const ElementVectors& position, const ElementVectors& displacement,
                      int n_points);
ElementVectors element_force(const Material& material, const ElementVectors& position,
                             const ElementVectors& displacement, int n_points);

}  // namespace couplet::solid
