#pragma once
// Quadrature on the cube [-1, 1]^3 and the square [-1, 1]^2.

#include <Eigen/Core>
#include <vector>

namespace couplet::solid {

struct QuadraturePoint {
  Eigen::Vector3d xi;
  double weight = 0;
};

struct FaceQuadraturePoint {
  Eigen::Vector2d xi;
  double weight = 0;
};

/// 8 points: Gauss 2 x 2 x 2, exact to degree 3 in each direction. 14 points: Irons 1971, exact to total degree 5. 27
/// points: Gauss 3 x 3 x 3, exact to degree 5 in each direction. Throws SceneError for any other number.
std::vector<QuadraturePoint> element_quadrature(int n_points);

/// Gauss 3 x 3: exact to degree 5 in each direction.
std::vector<FaceQuadraturePoint> face_quadrature();

}  // namespace couplet::solid
