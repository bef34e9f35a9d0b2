#include "flow-server/poisson/coarsening.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "flow-server/grid/stretched_axis.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

LevelAxis axis_of(const std::vector<double>& faces, bool is_periodic = false, bool has_terms = true) {
  LevelAxis axis;
  for (std::size_t i = 1; i < faces.size(); ++i) axis.width.push_back(faces[i] - faces[i - 1]);
  axis.is_periodic = is_periodic, axis.has_terms = has_terms;
  return axis;
}

TEST(Coarsening, CubesMergeInPairsInEveryDirection) {
  const LevelAxis axis = axis_of(uniform_faces(0, 1, 64));
  const LevelPlan plan = plan_levels({axis, axis, axis});
  for (int l = 0; l < plan.n_levels(); ++l) EXPECT_EQ(plan.n_cells(l), (Triple{64 >> l, 64 >> l, 64 >> l}));
  EXPECT_EQ(plan.n_cells(plan.n_levels() - 1), (Triple{4, 4, 4}));
}

TEST(Coarsening, LongCellsAreFirstMergedAcross) {
  const LevelPlan plan = plan_levels(
      {axis_of(uniform_faces(0, 50, 32)), axis_of(uniform_faces(0, 1, 32)), axis_of(uniform_faces(0, 1, 32))});
  EXPECT_EQ(plan.n_cells(1), (Triple{32, 16, 16}));
}

TEST(Coarsening, CoarseCellsCoverTheSameLengths) {
  const LevelAxis stretched = axis_of(symmetrically_stretched_faces(0, 1, 53, 20));
  const LevelPlan plan = plan_levels({stretched, axis_of(uniform_faces(0, 1, 37)), stretched});
  for (const auto& axes : plan.axes)
    for (const LevelAxis& axis : axes)
      EXPECT_NEAR(std::accumulate(axis.width.begin(), axis.width.end(), 0.0), 1, 1e-12);  // round-off of 53 terms
  for (const auto& merging : plan.merging)
    for (const Merging& one : merging)
      for (int c = 0; c < one.n_coarse(); ++c) {
        EXPECT_LE(one.first[c + 1] - one.first[c], 3);
        for (int i = one.first[c]; i < one.first[c + 1]; ++i) EXPECT_EQ(one.coarse_of(i), c);
      }
}

TEST(Coarsening, TheSmallestWidthDoublesFromLevelToLevel) {
  const LevelAxis axis = axis_of(symmetrically_stretched_faces(0, 1, 128, 20));
  const LevelPlan plan = plan_levels({axis, axis, axis});
  const auto smallest = [&](int l) {
    const auto& width = plan.axes[static_cast<std::size_t>(l)][0].width;
    return *std::min_element(width.begin(), width.end());
  };
  // A level can be left with one cell that found no partner; not more often than that.
  EXPECT_LE(plan.n_levels(), 2 + std::log2(20) + std::log2(128));
  EXPECT_GT(smallest(3), 4 * smallest(0));
}

TEST(Coarsening, PeriodicDirectionsKeepAnEvenNumberOfCells) {
  for (const int n : {4, 6, 10, 22, 38, 74, 90, 126})
    for (const double stretching : {1.0, 7.0}) {
      const LevelAxis axis = axis_of(symmetrically_stretched_faces(0, 1, n, stretching), true);
      const LevelPlan plan = plan_levels({axis, axis, axis});
      for (int l = 0; l < plan.n_levels(); ++l) {
        EXPECT_EQ(plan.n_cells(l)[0] % 2, 0) << n;
        EXPECT_GE(plan.n_cells(l)[0], 4) << n;
      }
      const Triple last = plan.n_cells(plan.n_levels() - 1);
      EXPECT_LE(last[0] * last[1] * last[2], coarsest_size) << n;
    }
}

TEST(Coarsening, AnOddPeriodicDirectionIsRefused) {
  const LevelAxis odd = axis_of(uniform_faces(0, 1, 33), true), even = axis_of(uniform_faces(0, 1, 32), true);
  EXPECT_FALSE(can_colour({even, odd, even}));
  EXPECT_THROW(plan_levels({even, odd, even}), report::SceneError);
  EXPECT_NO_THROW(plan_levels({even, even, even}));
}

TEST(Coarsening, TwoDimensionsStayTwo) {
  const LevelAxis axis = axis_of(uniform_faces(0, 1, 64));
  const LevelPlan plan = plan_levels({axis, axis, axis_of({0, 0.01}, false, false)});
  EXPECT_EQ(plan.n_cells(1), (Triple{32, 32, 1}));
  EXPECT_EQ(axis_of({0, 0.01}, false, false).lower(0), 0);
}

TEST(Coarsening, OneDimensionalOperatorIsSymmetricInVolumeAndHalvesTheDistanceAtOpenBorders) {
  LevelAxis axis = axis_of(symmetrically_stretched_faces(0, 1, 9, 5));
  axis.border_is_open = {true, false};
  for (int i = 0; i + 1 < axis.n_cells(); ++i)
    EXPECT_DOUBLE_EQ(axis.width[i] * axis.upper(i), axis.width[i + 1] * axis.lower(i + 1));
  EXPECT_DOUBLE_EQ(axis.lower(0), 2 / (axis.width[0] * axis.width[0]));
  EXPECT_EQ(axis.upper(8), 0);
}

TEST(Coarsening, PartitionsStandOnBordersOfCoarseCells) {
  const LevelAxis axis = axis_of(symmetrically_stretched_faces(0, 1, 100, 6));
  const LevelPlan plan = plan_levels({axis, axis, axis});
  const std::vector<Partition> parts = aligned_partitions(plan, 0, {1, 4, 3});
  ASSERT_EQ(parts.size(), 3u);
  for (int d = 0; d < 3; ++d) {
    EXPECT_EQ(parts[static_cast<std::size_t>(d)].n_cells(), 100);
    for (const int start : parts[static_cast<std::size_t>(d)].start)
      EXPECT_TRUE(plan.merging[0][d].has_border_at(start));
  }
}

}  // namespace
}  // namespace couplet::flow
