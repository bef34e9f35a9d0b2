#include "solid-server/contact/rolling_ball.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solid-server/contact/closest_point.hpp"

namespace couplet::solid {
namespace {

constexpr double radius = 0.2;

NodeQuad place(double x, double y, double z) {
  return NodeQuad{x, y, z, 0};
}

CurvedFace flat(const NodeQuad& a, const NodeQuad& b, const NodeQuad& c, const NodeQuad& d) {
  return {FaceShape::quadrilateral4, {a, b, c, d}};
}

/// Two squares of side 1 that meet on the y axis and rise to both sides by the angle theta: normals (-+sin, 0, cos).
std::vector<CurvedFace> valley(double theta) {
  const double c = std::cos(theta), s = std::sin(theta);
  return {flat(place(0, -0.5, 0), place(c, -0.5, s), place(c, 0.5, s), place(0, 0.5, 0)),
          flat(place(-c, -0.5, s), place(0, -0.5, 0), place(0, 0.5, 0), place(-c, 0.5, s))};
}

double distance(const std::vector<CurvedFace>& faces, const NodeQuad& x) {
  return std::min(closest_point(faces[0], x).distance, closest_point(faces[1], x).distance);
}

/// From the closest face first, as its caller does.
RoundedDistance rounded(std::vector<CurvedFace> faces, const NodeQuad& x) {
  std::size_t nearest = 0;
  ClosestPoint closest = closest_point(faces[0], x);
  for (std::size_t f = 1; f < faces.size(); ++f)
    if (const ClosestPoint here = closest_point(faces[f], x); here.distance < closest.distance) {
      closest = here;
      nearest = f;
    }
  std::swap(faces[0], faces[nearest]);
  return rounded_distance(faces, x, closest.distance, (x - closest.position) / closest.distance, radius);
}

TEST(RoundedDistance, IsTheMoreauEnvelopeAboveTheMiddleOfAValley) {
  for (const double theta : {0.5, 0.05, 1e-3}) {
    const double height = 0.03;
    const RoundedDistance above = rounded(valley(theta), place(0, 0.1, height));
    // Both planes are height cos(theta) away, the mean of their normals is cos(theta) long.
    const double exact = height * std::cos(theta) - radius / 2 * std::pow(std::sin(theta), 2);
    EXPECT_NEAR(above.distance, exact, 1e-15);
    ASSERT_EQ(above.touch.size(), 2u);
    // Slopes that differ by 1e-14 rho are alike: that much over their change with the share, 4 rho sin^2(theta).
    EXPECT_NEAR(above.touch[0].share, 0.5, 1e-14 / std::pow(std::sin(theta), 2));
    EXPECT_NEAR(above.direction[0], 0, 1e-12);
    EXPECT_NEAR(above.direction[2], std::cos(theta), 1e-12);
  }
}

TEST(RoundedDistance, LeavesFlushFacesAndRidgesAlone) {
  for (const double theta : {0.0, -0.05, -0.7})
    for (const double s : {0.001, 0.01, 0.1}) {
      const NodeQuad x = place(s, 0.2, 0.04);
      const RoundedDistance beside = rounded(valley(theta), x);
      ASSERT_EQ(beside.touch.size(), 1u);
      EXPECT_NEAR(beside.distance, distance(valley(theta), x), 1e-15);
    }
}

TEST(RoundedDistance, LeavesTheSidesOfAValleyAlone) {
  const double theta = 0.05;  // the ball touches both sides within rho sin(theta) of the middle, here 0.01
  EXPECT_EQ(rounded(valley(theta), place(0.0095, 0, 0.03)).touch.size(), 2u);
  const NodeQuad outside = place(0.0105, 0, 0.03);
  EXPECT_EQ(rounded(valley(theta), outside).touch.size(), 1u);
  EXPECT_NEAR(rounded(valley(theta), outside).distance, distance(valley(theta), outside), 1e-15);
}

TEST(RoundedDistance, StaysTheSameFunctionBehindTheFaces) {
  for (const double theta : {0.3, 0.02})
    for (const double height : {-0.01, -0.15, -0.3, -1.0}) {
      const NodeQuad x = place(0, 0.1, height), up = place(0, 0, 1);
      const RoundedDistance behind = rounded_distance(valley(theta), x, height, up, radius);
      EXPECT_NEAR(behind.distance, height * std::cos(theta) - radius / 2 * std::pow(std::sin(theta), 2), 1e-14);
      EXPECT_NEAR(behind.direction[2], std::cos(theta), 1e-12);
    }
}

/// Over a corner of four faces that are bent in two ways: valleys, a saddle, and valleys across which nothing is bent.
TEST(RoundedDistance, HasAContinuousGradient) {
  for (const auto& [bend_x, bend_y] : {std::pair(0.1, 0.06), std::pair(0.1, 0.0), std::pair(0.1, -0.05)}) {
    const auto node = [&, bx = bend_x, by = bend_y](double x, double y) {
      return place(x, y, bx * std::abs(x) + by * std::abs(y));
    };
    std::vector<CurvedFace> faces;
    for (const double x : {-1.0, 0.0})
      for (const double y : {-1.0, 0.0})
        faces.push_back(flat(node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)));
    const double h = 1e-6;
    for (int n = 0; n < 400; ++n) {  // a line past the corner
      const NodeQuad x = place(0.05 - 0.00023 * n, -0.02 + 0.00011 * n, 0.05);
      RoundedDistance here = rounded(faces, x);
      for (int i = 0; i < 3; ++i) {
        NodeQuad step{};
        step[i] = h;
        const double slope = (rounded(faces, x + step).distance - rounded(faces, x - step).distance) / (2 * h);
        // The second derivative jumps, and is at most 1 / rho, or 1 / d over a ridge: error h / 2 d.
        EXPECT_NEAR(here.direction[i], slope, 2e-5) << "bends " << bend_x << ", " << bend_y << ", place " << n;
      }
    }
  }
}

}  // namespace
}  // namespace couplet::solid
