#include "flow-server/immersed/edge_clearance.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr double strip_reach = 0.5;

TEST(EdgeClearance, IsTheWayToTheBorderThatTheEdgeGoesTo) {
  const StretchedGrid grid = uniform_box({10, 10, 10}, 0.1);
  EXPECT_NEAR(edge_clearance(grid, {}, {0.5, 0.2, 0.5}, {0, -1, 0}, strip_reach), 0.2, 1e-15);
  EXPECT_NEAR(edge_clearance(grid, {}, {0.5, 0.2, 0.5}, {0.6, -0.8, 0}, strip_reach), 0.25, 1e-15);
  EXPECT_NEAR(edge_clearance(grid, {}, {0.9, 0.2, 0.5}, {0.6, -0.8, 0}, strip_reach), 0.1 / 0.6, 1e-15);
  EXPECT_EQ(edge_clearance(grid, {}, {0.5, 0, 0.5}, {0, -1, 0}, strip_reach), 0);
  EXPECT_EQ(edge_clearance(grid, {}, {0.5, -0.3, 0.5}, {0, -1, 0}, strip_reach), 0);
  EXPECT_TRUE(std::isinf(edge_clearance(grid, {}, {0.5, 0.2, 0.5}, {0, 1, 0}, strip_reach)));   // far on that side
  EXPECT_TRUE(std::isinf(edge_clearance(grid, {}, {0.5, 0.01, 0.5}, {1, 0, 0}, strip_reach)));  // goes along the border
}

TEST(EdgeClearance, InTwoDimensionsAndWherePeriodicThereIsNoBorder) {
  EXPECT_TRUE(std::isinf(edge_clearance(uniform_box({10, 10, 1}, 0.1, 2), {}, {0.5, 0.5, 0}, {0, 0, -1}, strip_reach)));
  EXPECT_TRUE(std::isinf(
      edge_clearance(uniform_box({10, 10, 10}, 0.1, 3, true), {}, {0.5, 0.01, 0.5}, {0, -1, 0}, strip_reach)));
}

TEST(EdgeClearance, IsTheWayToABodyAndZeroInsideIt) {
  const StretchedGrid grid = uniform_box({40, 40, 40}, 0.1);
  const BodySurface ball = sphere_surface({2, 2, 2}, 0.5, 5);
  const std::array<SurfaceInTree, 1> in_tree{SurfaceInTree{&ball, {}, static_cast<int>(ball.triangle.size())}};
  const SurfaceTree tree(in_tree);
  const std::array<EdgeObstacle, 1> obstacle{EdgeObstacle{&ball, &tree}};
  // The triangles lie up to 1e-3 inside the sphere.
  EXPECT_NEAR(edge_clearance(grid, obstacle, {2, 2.6, 2}, {0, -1, 0}, strip_reach), 0.1, 1.5e-3);
  EXPECT_EQ(edge_clearance(grid, obstacle, {2, 2.45, 2}, {0, -1, 0}, strip_reach), 0);
  EXPECT_TRUE(std::isinf(edge_clearance(grid, obstacle, {2, 2.6, 2}, {1, 0, 0}, strip_reach)));  // goes past it
  EXPECT_TRUE(std::isinf(edge_clearance(grid, obstacle, {2, 2.6, 2}, {0, 1, 0}, strip_reach)));  // away from it
  EXPECT_TRUE(
      std::isinf(edge_clearance(grid, obstacle, {2, 3.1, 2}, {0, -1, 0}, strip_reach)));  // beyond its strip_reach
}

}  // namespace
}  // namespace couplet::flow
