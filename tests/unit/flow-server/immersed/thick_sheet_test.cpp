#include "flow-server/immersed/thick_sheet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

/// A plate bent to a saddle, whose corners move at random.
BodySurface bent_plate(double side) {
  BodySurface sheet = surface_of(make_rectangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, side), false);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  for (std::size_t c = 0; c < sheet.position.size(); ++c) {
    Point& p = sheet.position[c];
    p[2] = 0.2 * (p[0] - 1) * (p[1] - 0.3);
    sheet.velocity[c] = {number(random), number(random), number(random)};
  }
  return sheet;
}

TEST(ThickSheet, IsClosedAndAsThickAsItShouldBe) {
  BodySurface sheet = bent_plate(0.1);
  const SurfaceTopology topology = orient_surface(sheet, FluidSide::outside, {});
  BodySurface body = ThickSheet(sheet, topology, 0.06).surface();
  double area = 0;
  for (const auto& [a, b, c] : sheet.triangle)
    area += length(area_vector(sheet.position[static_cast<std::size_t>(a)], sheet.position[static_cast<std::size_t>(b)],
                               sheet.position[static_cast<std::size_t>(c)]));
  const SurfaceTopology closed = orient_surface(body, FluidSide::outside, {});  // throws where it has holes
  EXPECT_TRUE(closed.notes.empty());                                            // nothing had to be turned
  EXPECT_NEAR(closed.volume, 0.06 * area, 1e-3 * 0.06 * area);  // thickness times curvature 0.2, squared
  for (std::size_t c = 0; c < sheet.position.size(); ++c)
    EXPECT_NEAR(distance(body.position[c], body.position[c + sheet.position.size()]), 0.06, 1e-14);
}

TEST(ThickSheet, VelocitiesAreTheRatesOfPositions) {
  BodySurface sheet = bent_plate(0.3);
  ThickSheet thick(sheet, orient_surface(sheet, FluidSide::outside, {}), 0.1);
  const double dt = 1e-5;
  BodySurface moved[2] = {sheet, sheet};
  std::vector<Point> position[2];
  for (int k = 0; k < 2; ++k) {
    for (std::size_t c = 0; c < sheet.position.size(); ++c)
      moved[k].position[c] = sheet.position[c] + (k == 0 ? -dt : dt) * sheet.velocity[c];
    thick.update(moved[k]);
    position[k] = thick.surface().position;
  }
  thick.update(sheet);
  for (std::size_t c = 0; c < position[0].size(); ++c) {
    const Point rate = (0.5 / dt) * (position[1][c] - position[0][c]);
    EXPECT_LT(distance(rate, thick.surface().velocity[c]), 1e-8);  // central difference: dt^2 times rates of 10
  }
}

TEST(ThickSheet, GatheringKeepsSumAndWork) {
  BodySurface sheet = bent_plate(0.2);
  const ThickSheet thick(sheet, orient_surface(sheet, FluidSide::outside, {}), 0.1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Point> force(thick.surface().position.size());
  Point sum{}, gathered{};
  double work = 0, gathered_work = 0;
  for (std::size_t c = 0; c < force.size(); ++c) {
    force[c] = {number(random), number(random), number(random)};
    sum = sum + force[c];
    work += dot(force[c], thick.surface().velocity[c]);
  }
  thick.gather(force);
  ASSERT_EQ(force.size(), sheet.position.size());
  for (std::size_t c = 0; c < force.size(); ++c) {
    gathered = gathered + force[c];
    gathered_work += dot(force[c], sheet.velocity[c]);
  }
  EXPECT_LT(distance(sum, gathered), 1e-11);  // round-off of a few hundred forces of 1
  EXPECT_NEAR(work, gathered_work, 1e-11);
}

TEST(ThickSheet, EndsOnTheBordersOnWhichTheSheetEnds) {
  // In two dimensions: a prism with rims at its true ends only.
  const std::vector<BorderPlane> planes = {{2, 0}, {2, 1}};
  BodySurface sheet = surface_of(make_sheet_prism({{0, 0}, {1, 0.5}, {3, 0}}, {}, 0.2), false);
  const SurfaceTopology topology = orient_surface(sheet, FluidSide::outside, planes);
  BodySurface body = ThickSheet(sheet, topology, 0.1).surface();
  EXPECT_EQ(body.triangle.size(), 2 * sheet.triangle.size() + 4);
  for (const Point& p : body.position) EXPECT_TRUE(p[2] == 0 || p[2] == 1);
  // The mean normal at the bend leaves the sides a little nearer to each other there: cos of half of 40.6 degrees.
  const double length_of_chain = std::hypot(1, 0.5) + std::hypot(2, 0.5);
  EXPECT_NEAR(orient_surface(body, FluidSide::outside, planes).volume, 0.1 * length_of_chain, 0.1 * 0.2 * 0.07);
}

}  // namespace
}  // namespace couplet::flow
