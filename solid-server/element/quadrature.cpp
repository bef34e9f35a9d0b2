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

/// Four points on the lines from the centre to the corners: barycentric (5 + 3 sqrt 5)/20 and three times
/// (5 - sqrt 5)/20.
std::vector<QuadraturePoint> tetrahedron_4() {
  const double b = (5 - std::sqrt(5)) / 20, a = 1 - 3 * b;
  return {{{b, b, b}, 1.0 / 24}, {{a, b, b}, 1.0 / 24}, {{b, a, b}, 1.0 / 24}, {{b, b, a}, 1.0 / 24}};
}

/// Keast 1986 (Computer Methods in Applied Mechanics and Engineering 55:339), rule 6: the centre, two sets of four
/// points on the lines to the corners, six on the lines to the middles of the edges. Weights add up to 1/6.
std::vector<QuadraturePoint> tetrahedron_15() {
  std::vector<QuadraturePoint> points = {{{0.25, 0.25, 0.25}, 0.030283678097089}};
  for (const auto& [b, weight] : {std::pair{1.0 / 3, 0.006026785714286}, std::pair{1.0 / 11, 0.011645249086029}}) {
    const double a = 1 - 3 * b;
    points.push_back({{b, b, b}, weight});
    for (int k = 0; k < 3; ++k)
      points.push_back({Eigen::Vector3d::Constant(b) + (a - b) * Eigen::Vector3d::Unit(k), weight});
  }
  const double c = 0.066550153573664, d = 0.5 - c;
  for (const Eigen::Vector3d& xi : {Eigen::Vector3d(c, c, d), Eigen::Vector3d(c, d, c), Eigen::Vector3d(d, c, c),
                                    Eigen::Vector3d(d, d, c), Eigen::Vector3d(d, c, d), Eigen::Vector3d(c, d, d)})
    points.push_back({xi, 0.010949141561386});
  return points;
}

/// Radon 1948: the centre and two sets of three points.
std::vector<FaceQuadraturePoint> triangle_7() {
  std::vector<FaceQuadraturePoint> points = {{{1.0 / 3, 1.0 / 3}, 9.0 / 80}};
  for (const double sign : {1.0, -1.0}) {
    const double b = (6 + sign * std::sqrt(15)) / 21, weight = (155 + sign * std::sqrt(15)) / 2400;
    points.push_back({{b, b}, weight});
    points.push_back({{1 - 2 * b, b}, weight});
    points.push_back({{b, 1 - 2 * b}, weight});
  }
  return points;
}

}  // namespace

std::vector<QuadraturePoint> element_quadrature(ElementShape shape, int n_points) {
  if (shape == ElementShape::tetrahedron10) {
    if (n_points == 4) return tetrahedron_4();
    if (n_points == 15) return tetrahedron_15();
  } else {
    if (n_points == 1) return {{Eigen::Vector3d::Zero(), 8}};
    if (n_points == 8) return gauss_cube(2);
    if (n_points == 14) return irons();
    if (n_points == 27) return gauss_cube(3);
  }
  throw report::SceneError(
      "solid.body.points_per_element",
      std::string("there is no quadrature with ") + std::to_string(n_points) + " points for " + topology(shape).name,
      shape == ElementShape::tetrahedron10 ? "choose 4" : "choose 8, 14 or 27");
}

int n_mass_points(ElementShape shape) {
  return shape == ElementShape::tetrahedron10 ? 15 : 27;
}

std::vector<FaceQuadraturePoint> face_quadrature(FaceShape shape) {
  if (shape == FaceShape::triangle6) return triangle_7();
  std::vector<FaceQuadraturePoint> points;
  for (const auto& q : gauss_line(3))
    for (const auto& p : gauss_line(3)) points.push_back({{p.x, q.x}, p.weight * q.weight});
  return points;
}

}  // namespace couplet::solid
