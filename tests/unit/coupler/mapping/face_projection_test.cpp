#include "coupler/mapping/face_projection.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "coupler/mapping/face_shape.hpp"

namespace couplet::coupling {
namespace {

using Eigen::Vector3d;

Vector3d point_on(const FaceNodes& nodes, double a, double b) {
  const FaceShape shape = face_shape(static_cast<int>(nodes.cols()), a, b);
  Vector3d point = Vector3d::Zero();
  for (int k = 0; k < nodes.cols(); ++k) point += shape.value[k] * nodes.col(k);
  return point;
}

/// A slightly bent and distorted face of unit size.
FaceNodes bent_face(int n_nodes) {
  FaceNodes nodes(3, n_nodes);
  const double corner[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  const double triangle[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  for (int k = 0; k < n_nodes; ++k) {
    const double* at = is_triangle(n_nodes) ? triangle[k] : corner[k];
    const double x = at[0] + 0.1 * at[0] * at[1], y = at[1] - 0.05 * at[0];
    nodes.col(k) = Vector3d(x, y, 0.15 * x * x - 0.1 * y * y);
  }
  return nodes;
}

/// Squared distance by trying very many places.
double searched(const FaceNodes& nodes, const Vector3d& point) {
  const bool triangle = is_triangle(static_cast<int>(nodes.cols()));
  double best = std::numeric_limits<double>::infinity();
  const int n = 300;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double a = triangle ? 1.0 * i / n : -1 + 2.0 * i / n, b = triangle ? 1.0 * j / n : -1 + 2.0 * j / n;
      if (triangle && a + b > 1 + 1e-12) continue;
      best = std::min(best, (point_on(nodes, a, b) - point).squaredNorm());
    }
  }
  return best;
}

class FaceProjection : public testing::TestWithParam<int> {};

TEST_P(FaceProjection, ShapeFunctionsAreOneAtTheirNodeAndSumToOne) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(0, 0.5);
  const double a = uniform(generator), b = uniform(generator), h = 1e-6;
  const FaceShape shape = face_shape(GetParam(), a, b);
  double sum = 0, sum_a = 0, sum_b = 0;
  for (int k = 0; k < GetParam(); ++k) {
    sum += shape.value[k];
    sum_a += shape.along_a[k];
    sum_b += shape.along_b[k];
    const double slope_a =
        (face_shape(GetParam(), a + h, b).value[k] - face_shape(GetParam(), a - h, b).value[k]) / (2 * h);
    const double slope_b =
        (face_shape(GetParam(), a, b + h).value[k] - face_shape(GetParam(), a, b - h).value[k]) / (2 * h);
    EXPECT_NEAR(shape.along_a[k], slope_a, 1e-9);  // round-off 1e-16 / h; cubic at most, so h^2 = 1e-12
    EXPECT_NEAR(shape.along_b[k], slope_b, 1e-9);
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  EXPECT_NEAR(sum_a, 0, 1e-14);
  EXPECT_NEAR(sum_b, 0, 1e-14);
}

TEST_P(FaceProjection, FindsTheFootOfAPerpendicular) {
  const FaceNodes nodes = bent_face(GetParam());
  const double a = 0.31, b = 0.22, h = 1e-6;
  const Vector3d foot = point_on(nodes, a, b);
  const Vector3d normal = (point_on(nodes, a + h, b) - foot).cross(point_on(nodes, a, b + h) - foot).normalized();
  const FacePoint found = project_on_face(nodes, foot + 0.05 * normal);
  EXPECT_NEAR(found.a, a, 1e-6);  // the normal above is good to h
  EXPECT_NEAR(found.b, b, 1e-6);
  EXPECT_NEAR(found.squared_distance, 0.05 * 0.05, 1e-12);
}

TEST_P(FaceProjection, IsNeverFartherThanAnyPointOfAFineSearch) {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> uniform(-1.6, 1.6), height(-0.3, 0.3);
  const FaceNodes nodes = bent_face(GetParam());
  for (int trial = 0; trial < 40; ++trial) {
    const Vector3d point(uniform(generator), uniform(generator), height(generator));
    const FacePoint found = project_on_face(nodes, point);
    EXPECT_LE(found.squared_distance, searched(nodes, point) + 1e-12) << point.transpose();
    EXPECT_NEAR((point_on(nodes, found.a, found.b) - point).squaredNorm(), found.squared_distance, 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryFace, FaceProjection, testing::Values(3, 4, 6, 8));

}  // namespace
}  // namespace couplet::coupling
