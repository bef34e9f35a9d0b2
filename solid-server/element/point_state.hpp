#pragma once
// Deformation and stress inside one element, point by point: for results that people look at.

#include "solid-server/element/formulation.hpp"
#include "solid-server/element/tangent.hpp"

namespace couplet::solid {

/// At one point.
struct PointState {
  Eigen::Matrix3d F;        // dx/dX [1]
  double volume_ratio = 1;  // J as the law feels it: with the near-incompressible formulation its projection [1]
  Eigen::Matrix3d cauchy;   // sigma, force per area now [Pa]
};

/// At the quadrature points of an element, in the order of element_quadrature, as its formulation has them:
///   standard              sigma = P F^T / J;
///   near_incompressible   sigma = P_1 F^T / J + p I with P_1 = dW_1/dF, J = det F and the element's pressure p;
///   stabilised            one point, the mean F and its stress: what stabilises an element is no stress of the tissue.
/// Displacement (n_nodes, 3) [m]. Means nothing in an inverted element.
std::vector<PointState> point_states(const PlainElement& element, ElementFormulation formulation,
                                     const ElementVectors& displacement);

/// Brings numbers at the points of an element to its nodes, (n_nodes, n_points): values at the nodes of the trilinear
/// function (tetrahedra: linear; one point: constant) that is closest to the numbers, by the weights of the points.
/// With as many points as it has coefficients it takes them exactly [Hinton, Campbell 1974].
Eigen::MatrixXd points_to_nodes(ElementShape shape, int n_points);

}  // namespace couplet::solid
