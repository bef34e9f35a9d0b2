#include "flow-server/immersed/body_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flow-server/immersed/surface_topology.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;
const std::vector<BorderPlane> one_cell = {{2, 0}, {2, 1}};

double area_of(const BodySurface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangle)
    area +=
        length(area_vector(surface.position[static_cast<std::size_t>(a)], surface.position[static_cast<std::size_t>(b)],
                           surface.position[static_cast<std::size_t>(c)]));
  return area;
}

double longest_side(const BodySurface& surface, std::size_t n_dimensions) {
  double longest = 0;
  for (const auto& corners : surface.triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      Point side = surface.position[static_cast<std::size_t>(corners[(k + 1) % 3])] -
                   surface.position[static_cast<std::size_t>(corners[k])];
      if (n_dimensions == 2) side[2] = 0;
      longest = std::max(longest, length(side));
    }
  }
  return longest;
}

/// Closed without repair; its volume.
double volume_of(BodySurface& surface, std::span<const BorderPlane> planes = {}) {
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, planes);
  EXPECT_TRUE(topology.notes.empty());
  EXPECT_EQ(topology.n_parts, 1);
  return topology.volume;
}

TEST(BodyShape, RoundBodiesHaveTheTrueVolumeAndConvergeWithTheSquareOfTheSide) {
  std::vector<double> off_disc, off_ball, ball_area;
  for (const double side : {0.1, 0.05}) {
    BodySurface cylinder = surface_of(make_elliptic_cylinder({3, 4}, {1, 0.5}, {}, side), true);
    EXPECT_LE(longest_side(cylinder, 2), side);
    EXPECT_NEAR(volume_of(cylinder, one_cell), pi * 0.5, 1e-12);
    off_disc.push_back(std::hypot(cylinder.position[0][0] - 3, (cylinder.position[0][1] - 4) / 0.5) - 1);
    BodySurface ellipsoid = surface_of(make_ellipsoid({1, 2, 3}, {1, 0.5, 0.75}, side), true);
    EXPECT_LE(longest_side(ellipsoid, 3), side);
    EXPECT_NEAR(volume_of(ellipsoid), 4 * pi / 3 * 0.5 * 0.75, 1e-12);
    const BodySurface ball = surface_of(make_ellipsoid({0, 0, 0}, {1, 1, 1}, side), true);
    off_ball.push_back(length(ball.position[0]) - 1);
    ball_area.push_back(area_of(ball) / (4 * pi) - 1);
  }
  // Errors of chords are of second order: a factor of four, to the rounding of counts.
  EXPECT_NEAR(off_disc[0] / off_disc[1], 4, 0.2);
  EXPECT_NEAR(off_ball[0] / off_ball[1], 4, 0.6);
  EXPECT_NEAR(ball_area[0] / ball_area[1], 4, 0.6);
  EXPECT_LT(off_disc[0], 0.1 * 0.1 / 8);  // (side / radius)^2 / 8
  EXPECT_LT(off_ball[0], 0.1 * 0.1 / 8);
}

TEST(BodyShape, FlatBodiesAreExact) {
  BodySurface box = surface_of(make_box({0, 1, 2}, {2, 2, 2.5}, 0.3), true);
  EXPECT_LE(longest_side(box, 3), 0.3 * (1 + 1e-12));
  EXPECT_NEAR(volume_of(box), 1, 1e-13);
  EXPECT_NEAR(area_of(box), 2 * (2 * 1 + 1 * 0.5 + 2 * 0.5), 1e-12);

  for (const bool clockwise : {false, true}) {
    std::vector<PlanePoint> outline = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}};  // an L
    if (clockwise) std::reverse(outline.begin(), outline.end());
    BodySurface prism = surface_of(make_polygon_prism(outline, {}, 0.1), true);
    EXPECT_NEAR(volume_of(prism, one_cell), 4, 1e-13);
    EXPECT_EQ(prism.triangle.size(), 2u * 100u);  // a perimeter of 10
  }
}

TEST(BodyShape, PrismsSpanTheDepthExactlyInOneLayer) {
  const BodySurface surface = surface_of(make_elliptic_cylinder({0, 0}, {1, 1}, {-0.3, 0.7, true}, 0.01), true);
  for (const Point& p : surface.position) EXPECT_TRUE(p[2] == -0.3 || p[2] == 0.7);
  const BodySurface layers = surface_of(make_elliptic_cylinder({0, 0}, {1, 1}, {0, 1, false}, 0.25), true);
  EXPECT_LE(longest_side(layers, 3), 0.25);
}

TEST(BodyShape, SheetsFaceAsTheySay) {
  const BodySurface plate = surface_of(make_rectangle({1, 1, 1}, {2, 0, 0}, {0, 3, 0}, 0.5), false);
  EXPECT_NEAR(area_of(plate), 6, 1e-12);
  for (const auto& [a, b, c] : plate.triangle)
    EXPECT_GT(area_vector(plate.position[static_cast<std::size_t>(a)], plate.position[static_cast<std::size_t>(b)],
                          plate.position[static_cast<std::size_t>(c)])[2],
              0);
  const BodySurface segment = surface_of(make_sheet_prism({{0, 0}, {1, 0}, {1, 1}}, {}, 0.2), false);
  EXPECT_NEAR(area_of(segment), 2, 1e-12);
  const auto [a, b, c] = segment.triangle[0];  // on the part along x: its right is -y
  EXPECT_LT(area_vector(segment.position[static_cast<std::size_t>(a)], segment.position[static_cast<std::size_t>(b)],
                        segment.position[static_cast<std::size_t>(c)])[1],
            0);
}

TEST(BodyShape, ATubeFacesItsAxis) {
  BodySurface tube = surface_of(make_tube({0, 1, 1}, {2, 1, 1}, 0.5, 0.1), true);
  const SurfaceTopology topology = orient_surface(tube, FluidSide::inside, {});
  EXPECT_TRUE(topology.notes.empty());
  EXPECT_TRUE(topology.free_edge.empty());
  EXPECT_NEAR(-topology.volume, pi * 0.25 * 2, 0.01);
  EXPECT_NEAR(area_of(tube), pi * 2 + 2 * pi * 0.25, 0.015);
}

TEST(BodyShape, RevolvedBodiesAreClosed) {
  // From either end. Two cones on a common base of radius 1/2: V = pi r^2 h / 3 but for the chords of the base.
  std::vector<double> error;
  for (const double side : {0.1, 0.05}) {
    BodySurface turned = surface_of(make_revolved_body({{2, 0}, {0, 0.5}, {-1, 0}}, side), true);
    EXPECT_GT(volume_of(turned), 0);
    BodySurface body = surface_of(make_revolved_body({{-1, 0}, {0, 0.5}, {2, 0}}, side), true);
    EXPECT_LE(longest_side(body, 3), side * (1 + 1e-12));
    error.push_back(1 - volume_of(body) / (pi * 0.25 * 3 / 3));
  }
  EXPECT_NEAR(error[0] / error[1], 4, 0.6);
  EXPECT_LT(error[0], 0.2 * 0.2);
}

TEST(BodyShape, RuledSheetsReachFromEdgeToEdge) {
  // A trapezium of height 2 between sides of 1 and 0.5, with a kink in the middle of its edges; then one with a tip.
  for (const double tip : {0.5, 0.0}) {
    const BodySurface wing = surface_of(
        make_ruled_sheet({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}, {{1, 0, 0}, {0.5 + 0.5 * tip, 1, 0}, {tip, 2, 0}}, 0.1),
        false);
    EXPECT_LE(longest_side(wing, 3), 0.1 * (1 + 1e-12));
    EXPECT_NEAR(area_of(wing), 1 + tip, 1e-12);
    for (const auto& [a, b, c] : wing.triangle)  // along y x along x = -z
      EXPECT_LT(area_vector(wing.position[static_cast<std::size_t>(a)], wing.position[static_cast<std::size_t>(b)],
                            wing.position[static_cast<std::size_t>(c)])[2],
                0);
    BodySurface turned = wing;
    const SurfaceTopology topology = orient_surface(turned, FluidSide::outside, {});
    EXPECT_TRUE(topology.notes.empty());
    EXPECT_EQ(topology.n_parts, 1);
  }
}

}  // namespace
}  // namespace couplet::flow
