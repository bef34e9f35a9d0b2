#include "flow-server/immersed/nearest_wall.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

/// Two sheets normal to x, at 1 and 2, the second one moving along y.
struct TwoSheets {
  TwoSheets()
      : surfaces{flat_sheet({1, -5, -5}, {0, 10, 0}, {0, 0, 10}, 8),
                 flat_sheet({2, -5, -5}, {0, 10, 0}, {0, 0, 10}, 8)} {
    surfaces[1].velocity.assign(surfaces[1].velocity.size(), Point{0, 3, 0});
    for (const BodySurface& surface : surfaces) {
      const std::array<SurfaceInTree, 1> in_tree{
          SurfaceInTree{&surface, {}, static_cast<int>(surface.triangle.size())}};
      trees.emplace_back(in_tree);
    }
    nearest.update(surfaces, trees);
  }

  std::vector<BodySurface> surfaces;
  std::vector<SurfaceTree> trees;
  NearestWall nearest;
};

NearbyWalls beside(std::initializer_list<int> surfaces) {
  NearbyWalls nearby;
  for (const int surface : surfaces) nearby.surfaces.add(surface);
  return nearby;
}

constexpr double round_off = 1e-12;  // of weights of corners some 10 away

TEST(NearestWall, OnlySurfacesThatCutCellsAroundCount) {
  TwoSheets walls;
  NearbyWalls both = beside({0, 1}), second = beside({1}), none;
  const Eigen::Vector3d place(1.2, 0.3, 0.4);
  const auto reach = [](const BodySurface&) { return 1.0; };
  EXPECT_EQ(walls.nearest.on_any(place, reach, both).surface, 0);
  EXPECT_EQ(walls.nearest.on_any(place, reach, second).surface, 1);
  EXPECT_FALSE(walls.nearest.on_any(place, reach, none).is_found());
  EXPECT_NEAR(walls.nearest.on_any(place, reach, second).distance, 0.8, round_off);
}

TEST(NearestWall, WhatIsRememberedCountsWithinTheReachOnly) {
  TwoSheets walls;
  NearbyWalls nearby = beside({0, 1});
  const Eigen::Vector3d place(1.3, 0.1, 0.2);
  EXPECT_FALSE(walls.nearest.on(1, place, 0.5, nearby).is_found());  // not found is not remembered
  const ClosestPoint far = walls.nearest.on(1, place, 2, nearby), near = walls.nearest.on(0, place, 2, nearby);
  EXPECT_NEAR(far.distance, 0.7, round_off);
  EXPECT_NEAR(near.distance, 0.3, round_off);
  EXPECT_FALSE(walls.nearest.on(1, place, 0.5, nearby).is_found());
  // From a memory as from the tree.
  const ClosestPoint again = walls.nearest.on(1, place, 0.75, nearby);
  EXPECT_EQ(again.surface, 1);
  EXPECT_EQ(again.triangle, far.triangle);
  EXPECT_EQ(again.weight, far.weight);
  EXPECT_EQ(walls.nearest.on(0, place, 0.75, nearby).triangle, near.triangle);
}

TEST(NearestWall, KnowsHowTheWallMoves) {
  TwoSheets walls;
  NearbyWalls first = beside({0}), second = beside({1});
  EXPECT_TRUE(walls.nearest.are_at_rest(first));
  EXPECT_FALSE(walls.nearest.are_at_rest(second));
  const ClosestPoint still = walls.nearest.on(0, {1.5, 0, 0}, 1, first),
                     moving = walls.nearest.on(1, {1.5, 0, 0}, 1, second);
  EXPECT_EQ(walls.nearest.velocity(still, 1), 0);
  EXPECT_NEAR(walls.nearest.velocity(moving, 1), 3, round_off);
  EXPECT_NEAR(std::abs(walls.nearest.normal(moving)[0]), 1, round_off);
  EXPECT_EQ(walls.nearest.opening(moving), 0);
}

TEST(NearestWall, ManySurfacesShareTheLastPlaceOfASet) {
  SurfaceSet set;
  set.add(40);
  EXPECT_TRUE(set.contains(40));
  EXPECT_TRUE(set.contains(31));
  EXPECT_FALSE(set.contains(30));
}

}  // namespace
}  // namespace couplet::flow
