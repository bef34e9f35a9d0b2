#include "flow-server/immersed/nearest_wall.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

struct Walls {
  std::vector<BodySurface> surfaces;
  std::vector<SurfaceTree> trees;
  NearestWall nearest;

  explicit Walls(std::vector<BodySurface> given) : surfaces(std::move(given)) {
    for (const BodySurface& surface : surfaces) {
      const std::array<SurfaceInTree, 1> in_tree{
          SurfaceInTree{&surface, {}, static_cast<int>(surface.triangle.size())}};
      trees.emplace_back(in_tree);
    }
    nearest.update(surfaces, trees);
  }
};

BodySurface floor_at(double height, double opening = 0) {
  BodySurface sheet = flat_sheet({-2, -2, height}, {4, 0, 0}, {0, 4, 0}, 4);
  if (opening > 0) sheet.opening.assign(sheet.position.size(), opening);
  return sheet;
}

const Eigen::Vector3d foot(0.1, -0.2, 0), up(0, 0, 1);

TEST(NearestWall, AGapIsAsWideAsTheOtherWallIsFarUpToTheMost) {
  for (const double height : {0.01, 0.3, 0.99, 1.9}) {
    Walls walls({floor_at(0), floor_at(height)});
    EXPECT_NEAR(walls.nearest.gap(foot, up, 2), height, 2e-3 * height);  // balls settle to a thousandth
  }
  Walls wide({floor_at(0), floor_at(2.5)});
  EXPECT_EQ(wide.nearest.gap(foot, up, 2), 2);
}

TEST(NearestWall, AWallThatOpensRecedes) {
  EXPECT_EQ(Walls({floor_at(0), floor_at(0.5, 1)}).nearest.gap(foot, up, 2), 2);
  const double ajar = Walls({floor_at(0), floor_at(0.5, 0.9)}).nearest.gap(foot, up, 2);
  EXPECT_GT(ajar, 0.6);
  EXPECT_LT(ajar, 2);
  EXPECT_NEAR(Walls({floor_at(0), floor_at(0.5, 0.7)}).nearest.gap(foot, up, 2), 0.5, 1e-3);
  // Nor does it hide what is behind it.
  EXPECT_NEAR(Walls({floor_at(0), floor_at(0.5, 1), floor_at(0.8)}).nearest.gap(foot, up, 2), 0.8, 2e-3);
}

TEST(NearestWall, InsideABallTheGapIsItsWidthOutsideThereIsNone) {
  Walls walls({sphere_surface({0, 0, 0}, 0.5, 5)});
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -0.5).normalized();
  // From a flat triangle, whose own neighbours are bent towards the ball and are no other wall.
  EXPECT_NEAR(walls.nearest.gap(0.5 * direction, -direction, 2), 1, 0.01);
  EXPECT_EQ(walls.nearest.gap(0.5 * direction, direction, 2), 2);
}

TEST(NearestWall, WhatCountsIsNearAndClosed) {
  Walls walls({floor_at(0, 0.9), floor_at(0.5)});
  EXPECT_EQ(walls.nearest.of_all({0, 0, 0.2}, 1).surface, 0);
  EXPECT_EQ(walls.nearest.that_counts({0, 0, 0.2}, 1, 1).surface, 1);   // 0.8 * 0.1 against 0.7
  EXPECT_EQ(walls.nearest.that_counts({0, 0, -0.3}, 1, 1).surface, 1);  // 0.7 * 0.1 against 0.2
  EXPECT_EQ(walls.nearest.that_counts({0, 0, -0.6}, 1, 1).surface, 0);  // the other one is out of reach
  EXPECT_FALSE(walls.nearest.that_counts({0, 0, -1.1}, 1, 1).is_found());
}

}  // namespace
}  // namespace couplet::flow
