// Started on 1 rank.
#include "flow-server/poisson/multigrid.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::flow {
namespace {

StretchedGrid grid_of(int n, bool is_periodic) {
  const StretchedAxis axis(symmetrically_stretched_faces(0, 1, n, 3), is_periodic);
  return {{axis, axis, axis}, 3};
}

TEST(Multigrid, SuitablePartitionsAreThoseThatCoarseCellsAllow) {
  const StretchedGrid even = grid_of(60, false), odd = grid_of(61, true);
  PressureProblem problem;
  problem.grid = &even;
  const LevelPlan plan = plan_levels(finest_axes(problem));
  for (const Partition& part : suitable_partitions(even, {2, 3, 4}))
    for (const int start : part.start) EXPECT_TRUE(plan.merging[0][0].has_border_at(start)) << start;
  // Where the multigrid cannot be used at all, parts are equal.
  EXPECT_EQ(suitable_partitions(odd, {1, 1, 4})[2].start, equal_parts(61, 4, 1).start);
}

TEST(Multigrid, ACycleTakesMostOfASmoothErrorAway) {
  const StretchedGrid grid = grid_of(32, false);
  const BlockDecomposition blocks(MPI_COMM_SELF, suitable_partitions(grid, {1, 1, 1}), {});
  PressureProblem problem;
  problem.grid = &grid, problem.decomposition = &blocks;
  problem.border_is_open = {{{true, true}, {true, true}, {true, true}}};
  Multigrid multigrid(problem);
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i)
        multigrid.rhs()(i, j, k) =
            static_cast<float>(-3 * M_PI * M_PI * std::sin(M_PI * grid.axis[0].centre(i)) *
                               std::sin(M_PI * grid.axis[1].centre(j)) * std::sin(M_PI * grid.axis[2].centre(k)));
  multigrid.cycle();
  // The solution is 1 in the middle; one cycle a decade of the residual is what is promised.
  EXPECT_NEAR(multigrid.correction()(16, 16, 16), 1, 0.1);
}

}  // namespace
}  // namespace couplet::flow
