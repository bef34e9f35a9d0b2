#include "flow-server/immersed/nearest_wall.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

struct Walls {
  explicit Walls(std::vector<BodySurface> given) : surfaces(std::move(given)) {
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

/// Two sheets normal to x, at 1 and 2, the second one moving along y.
std::vector<BodySurface> two_sheets() {
  std::vector<BodySurface> sheets;
  for (const double x : {1.0, 2.0}) sheets.push_back(flat_sheet({x, -5, -5}, {0, 10, 0}, {0, 0, 10}, 8));
  sheets[1].velocity.assign(sheets[1].velocity.size(), Point{0, 3, 0});
  return sheets;
}

BodySurface floor_at(double height, double opening = 0) {
  BodySurface sheet = flat_sheet({-2, -2, height}, {4, 0, 0}, {0, 4, 0}, 4);
  if (opening > 0) sheet.opening.assign(sheet.position.size(), opening);
  return sheet;
}

NearbyWalls beside(std::initializer_list<int> surfaces) {
  NearbyWalls nearby;
  for (const int surface : surfaces) nearby.surfaces.add(surface);
  return nearby;
}

constexpr double round_off = 1e-12;  // of weights of corners some 10 away

TEST(NearestWall, OnlySurfacesThatCutCellsAroundCount) {
  Walls walls(two_sheets());
  NearbyWalls both = beside({0, 1}), second = beside({1}), none;
  const Eigen::Vector3d place(1.2, 0.3, 0.4);
  const auto reach = [](const BodySurface&) { return 1.0; };
  EXPECT_EQ(walls.nearest.that_counts(place, reach, both).surface, 0);
  EXPECT_EQ(walls.nearest.that_counts(place, reach, second).surface, 1);
  EXPECT_FALSE(walls.nearest.that_counts(place, reach, none).is_found());
  EXPECT_NEAR(walls.nearest.that_counts(place, reach, second).distance, 0.8, round_off);
}

TEST(NearestWall, WhatIsRememberedCountsWithinTheReachOnly) {
  Walls walls(two_sheets());
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
  Walls walls(two_sheets());
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

TEST(NearestWall, WhatCountsIsNearAndClosed) {
  Walls walls({floor_at(0, 0.9), floor_at(0.5)});
  const auto counts_at = [&](double z) {
    NearbyWalls nearby = beside({0, 1});
    return walls.nearest
        .that_counts(
            {0, 0, z}, [](const BodySurface&) { return 1.0; }, nearby)
        .surface;
  };
  EXPECT_EQ(counts_at(0.2), 1);   // 0.8 * 0.1 against 0.7
  EXPECT_EQ(counts_at(-0.3), 1);  // 0.7 * 0.1 against 0.2
  EXPECT_EQ(counts_at(-0.6), 0);  // the other one is out of reach
  EXPECT_EQ(counts_at(-1.1), -1);
}

/// How wide the gap above the first surface is, up to 2.
double gap_above(std::vector<BodySurface> surfaces) {
  Walls walls(std::move(surfaces));
  NearbyWalls nearby = beside({0});
  return walls.nearest.gap(walls.nearest.on(0, {0.1, -0.2, 0}, 1, nearby), {0, 0, 1}, 2);
}

TEST(NearestWall, AGapIsAsWideAsTheOtherWallIsFarUpToTheMost) {
  for (const double height : {0.01, 0.3, 0.99, 1.9})
    EXPECT_NEAR(gap_above({floor_at(0), floor_at(height)}), height, 2e-3 * height);  // balls settle to a thousandth
  EXPECT_EQ(gap_above({floor_at(0), floor_at(2.5)}), 2);
}

TEST(NearestWall, AWallThatOpensRecedes) {
  EXPECT_EQ(gap_above({floor_at(0), floor_at(0.5, 1)}), 2);
  const double ajar = gap_above({floor_at(0), floor_at(0.5, 0.9)});
  EXPECT_GT(ajar, 0.6);
  EXPECT_LT(ajar, 2);
  EXPECT_NEAR(gap_above({floor_at(0), floor_at(0.5, 0.7)}), 0.5, 1e-3);
  // Nor does it hide what is behind it.
  EXPECT_NEAR(gap_above({floor_at(0), floor_at(0.5, 1), floor_at(0.8)}), 0.8, 2e-3);
}

TEST(NearestWall, InsideABallTheGapIsItsWidthOutsideThereIsNone) {
  Walls walls({sphere_surface({0, 0, 0}, 0.5, 5)});
  NearbyWalls nearby = beside({0});
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -0.5).normalized();
  const ClosestPoint wall = walls.nearest.on(0, 0.5 * direction, 0.1, nearby);
  // From a flat triangle, whose own neighbours are bent towards the ball and are no other wall.
  EXPECT_NEAR(walls.nearest.gap(wall, -direction, 2), 1, 0.01);
  EXPECT_EQ(walls.nearest.gap(wall, direction, 2), 2);
}

}  // namespace
}  // namespace couplet::flow
