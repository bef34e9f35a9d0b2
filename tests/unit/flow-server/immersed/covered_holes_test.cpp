#include "flow-server/immersed/covered_holes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/body_surfaces.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;

constexpr auto everywhere = [](const Point&) { return true; };

/// Of a box from the origin to (1, 1, 2), without its side at z = 2.
BodySurface open_box() {
  BodySurface surface = surface_of(make_box({0, 0, 0}, {1, 1, 2}, 0.25), true);
  std::erase_if(surface.triangle, [&](const std::array<int, 3>& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](int corner) { return surface.position[static_cast<std::size_t>(corner)][2] == 2; });
  });
  return surface;
}

TEST(CoveredHoles, GetALidOfWellShapedTriangles) {
  BodySurface surface = open_box();
  surface.is_closed = false;
  const SurfaceTopology open = orient_surface(surface, FluidSide::outside, {});
  EXPECT_EQ(close_covered_holes(surface, open, everywhere), 1);
  surface.is_closed = true;
  // No triangle without area, although corners of the rim lie on straight lines: that would be refused.
  const SurfaceTopology closed = orient_surface(surface, FluidSide::outside, {});
  EXPECT_TRUE(closed.notes.empty()) << closed.notes.front();
  EXPECT_NEAR(closed.volume, 2, 1e-14);
}

TEST(CoveredHoles, StayOpenWhereFluidReachesTheRim) {
  BodySurface surface = open_box();
  surface.is_closed = false;
  const SurfaceTopology open = orient_surface(surface, FluidSide::outside, {});
  EXPECT_EQ(close_covered_holes(surface, open, [](const Point& x) { return x[0] < 0.9; }), 0);
  surface.is_closed = true;
  EXPECT_THROW(orient_surface(surface, FluidSide::outside, {}), report::SceneError);
}

/// A flag in two dimensions, open where it is held, and a cylinder.
std::vector<BodySetup> flag_and_cylinder(double cylinder_x) {
  const DepthSpan depth{0, 1, true};
  BodySetup flag, cylinder;
  flag.name = "flag";
  flag.mesh = make_sheet_prism({{1, 0.9}, {2, 0.9}, {2, 1.1}, {1, 1.1}}, depth, 0.1);
  flag.closes_covered_holes = true;
  cylinder.name = "cylinder";
  cylinder.mesh = make_elliptic_cylinder({cylinder_x, 1}, {0.3, 0.3}, depth, 0.05);
  return {flag, cylinder};
}

TEST(CoveredHoles, AreClosedWhereABodyHoldsTheSolid) {
  BodySurfaces surfaces(flag_and_cylinder(0.8), uniform_box({30, 20, 1}, 0.1, 2));
  const std::vector<BodySurface> at_rest = surfaces.at(0);
  const std::vector<BorderPlane> planes{{2, 0}, {2, 1}};
  EXPECT_NEAR(enclosed_volume(at_rest[0], planes), 1 * 0.2 * 1, 1e-12);
  EXPECT_THAT(surfaces.notes(),
              testing::Contains(HasSubstr("body 'flag': 1 hole, which no fluid reaches, was closed")));
}

TEST(CoveredHoles, AreRefusedElsewhere) {
  try {
    BodySurfaces surfaces(flag_and_cylinder(0.3), uniform_box({30, 20, 1}, 0.1, 2));
    FAIL() << "was not refused";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("should be closed but has a hole: the edge from (1, "));
  }
}

}  // namespace
}  // namespace couplet::flow
