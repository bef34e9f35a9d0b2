#pragma once
// Quadrature on elements and faces in natural coordinates.

#include <Eigen/Core>
#include <vector>

#include "solid-server/mesh/element_shape.hpp"

namespace couplet::solid {

struct QuadraturePoint {
  Eigen::Vector3d xi;
  double weight = 0;
};

struct FaceQuadraturePoint {
  Eigen::Vector2d xi;
  double weight = 0;
};

/// Hexahedra: 1 point: the centre. 8 points: Gauss 2 x 2 x 2, exact to degree 3 in each direction. 14 points: Irons
/// 1971, exact to total degree 5. 27 points: Gauss 3 x 3 x 3, exact to degree 5 in each direction. Tetrahedra: 4
/// points, exact to total degree 2; 15 points [Keast 1986], exact to total degree 5. Throws SceneError for any other
/// number.
std::vector<QuadraturePoint> element_quadrature(ElementShape shape, int n_points);

/// The points for mass and volume: exact for products of two shape functions on elements with straight edges.
int n_mass_points(ElementShape shape);

/// Quadrilaterals: Gauss 3 x 3, exact to degree 5 in each direction. Triangles: 7 points [Radon 1948], exact to total
/// degree 5.
std::vector<FaceQuadraturePoint> face_quadrature(FaceShape shape);
constexpr int max_face_points = 9;

}  // namespace couplet::solid
