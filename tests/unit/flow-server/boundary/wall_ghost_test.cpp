#include "flow-server/boundary/wall_ghost.hpp"

#include <gtest/gtest.h>

namespace couplet::flow {
namespace {

TEST(WallGhost, IsThatOfTheTextbookOnEqualWidths) {
  // (8 u_b - 6 u_0 + u_1) / 3
  const GhostWeights ghost = parabolic_ghost(0.2, 0.2);
  EXPECT_NEAR(ghost.border, 8.0 / 3, 1e-14);
  EXPECT_NEAR(ghost.first, -2, 1e-14);
  EXPECT_NEAR(ghost.second, 1.0 / 3, 1e-14);
}

class WallGhostOfWidths : public testing::TestWithParam<double> {};

TEST_P(WallGhostOfWidths, GivesConstantsAndStraightLinesTheirSlope) {
  const double width = 0.1, next = GetParam() * width;
  const GhostWeights ghost = parabolic_ghost(width, next);
  EXPECT_NEAR(ghost.border + ghost.first + ghost.second, 1, 1e-13);
  // u = y: the ghost one width before u_0 is -width / 2.
  EXPECT_NEAR(ghost.first * 0.5 * width + ghost.second * (width + 0.5 * next), -0.5 * width, 1e-14);
}

TEST_P(WallGhostOfWidths, MakesDiffusionOfAParabolaExactWhereWidthsChangeLinearly) {
  const double width = 0.1, next = GetParam() * width;
  const auto u = [](double y) { return 3 + 2 * y - 5 * y * y; };
  const double first = u(0.5 * width), second = u(width + 0.5 * next);
  const GhostWeights ghost = parabolic_ghost(width, next);
  const double beyond = ghost.border * u(0) + ghost.first * first + ghost.second * second;
  const double diffusion = ((second - first) / (0.5 * (width + next)) - (first - beyond) / width) / width;
  EXPECT_NEAR(diffusion, -10, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Growth, WallGhostOfWidths, testing::Values(0.5, 0.9, 1.0, 1.1, 1.5, 2.0));

TEST(WallGhost, OfOneCellIsTheStraightLine) {
  const GhostWeights ghost = linear_ghost();
  EXPECT_EQ(ghost.border * 1.0 + ghost.first * 3.0, -1);  // 1 at the wall, 3 in the cell
  EXPECT_EQ(ghost.second, 0);
}

}  // namespace
}  // namespace couplet::flow
