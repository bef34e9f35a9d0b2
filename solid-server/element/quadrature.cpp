#include "solid-server/element/quadrature.hpp"

#include <cmath>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

struct LinePoint {
  double x, weight;
};

std::vector<LinePoint> gauss_line(int n_points) {
  if (n_points == 2) return {{-std::sqrt(1.0 / 3), 1}, {std::sqrt(1.0 / 3), 1}};
  return {{-std::sqrt(3.0 / 5), 5.0 / 9}, {0, 8.0 / 9}, {std::sqrt(3.0 / 5), 5.0 / 9}};
}

std::vector<QuadraturePoint> gauss_cube(int n_line) {
  std::vector<QuadraturePoint> points;
  const auto line = gauss_line(n_line);
  for (const auto& r : line)
    for (const auto& q : line)
      for (const auto& p : line) points.push_back({{p.x, q.x, r.x}, p.weight * q.weight * r.weight});
  return points;
}

/// Irons 1971: six points on the axes at sqrt(19/30), weight 320/361; eight on the diagonals at sqrt(19/33), weight
/// 121/361.
std::vector<QuadraturePoint> irons() {
  std::vector<QuadraturePoint> points;
  const double axis = std::sqrt(19.0 / 30), diagonal = std::sqrt(19.0 / 33);
  for (int k = 0; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) points.push_back({sign * axis * Eigen::Vector3d::Unit(k), 320.0 / 361});
  for (const double z : {-diagonal, diagonal})
    for (const double y : {-diagonal, diagonal})
      for (const double x : {-diagonal, diagonal}) points.push_back({{x, y, z}, 121.0 / 361});
  return points;
}

}  // namespace

std::vector<QuadraturePoint> element_quadrature(int n_points) {
  if (n_points == 8) return gauss_cube(2);
  if (n_points == 14) return irons();
  if (n_points == 27) return gauss_cube(3);
  throw report::SceneError("solid.body[0].points_per_element",
                           "there is no quadrature with " + std::to_string(n_points) + " points", "choose 8, 14 or 27");
}

std::vector<FaceQuadraturePoint> face_quadrature() {
  std::vector<FaceQuadraturePoint> points;
  for (const auto& q : gauss_line(3))
    for (const auto& p : gauss_line(3)) points.push_back({{p.x, q.x}, p.weight * q.weight});
  return points;
}

}  // namespace couplet::solid
