#include "solid-server/mesh/find_overlap.hpp"

#include <gtest/gtest.h>

#include "solid-server/mesh/parametric/ball_mesh.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/mesh/parametric/valve_mesh.hpp"
#include "solid-server/mesh/place_mesh.hpp"

namespace couplet::solid {
namespace {

/// A cube of 2 x 2 x 2 elements of size 0.5, and another thing that is moved along x.
SolidMesh cube_and(SolidMesh other, double x) {
  place_mesh(Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)), other);
  return join_bodies({make_box_mesh({{1, 1, 1}, {2, 2, 2}}), std::move(other)}, {"a", "b"});
}

std::optional<Overlap> overlap(const SolidMesh& mesh, const std::string& first, const std::string& second) {
  return find_overlap(mesh, mesh.find_surface(first, ""), mesh.find_surface(second, ""));
}

TEST(FindOverlap, SeesBodiesInsideEachOtherOnly) {
  const SolidMesh box = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  // The middle of the side of one lies inside the other, its rim on the other's surface.
  for (const double x : {0.4, 0.8, 0.94}) {
    const auto found = overlap(cube_and(box, x), "a/x_max", "b/x_min");
    ASSERT_TRUE(found) << x;
    EXPECT_GE(found->element, 8) << x;  // of b
    EXPECT_TRUE(overlap(cube_and(box, x), "b/x_min", "a/x_max")) << x;
  }
  for (const double x : {0.97, 1.0, 1.1}) EXPECT_FALSE(overlap(cube_and(box, x), "a/x_max", "b/x_min")) << x;
}

TEST(FindOverlap, KnowsABallInABoxByElementsOfAnyForm) {
  const SolidMesh ball = make_ball_mesh({0.3, {0.5, 0.5, 0.5}, BallPart::whole, false, 2});
  EXPECT_TRUE(overlap(cube_and(ball, 0.6), "b/surface", "a/x_max"));
  EXPECT_FALSE(overlap(cube_and(ball, 0.82), "b/surface", "a/x_max"));
}

TEST(FindOverlap, LetsLeafletsBeThatAlmostTouch) {
  const SolidMesh valve = make_valve_mesh({});
  for (const char* const other : {"contact_2", "contact_3"}) EXPECT_FALSE(overlap(valve, "contact_1", other));
  EXPECT_FALSE(overlap(valve, "contact", "contact"));
}

}  // namespace
}  // namespace couplet::solid
