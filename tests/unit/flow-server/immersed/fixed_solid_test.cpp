#include "flow-server/immersed/fixed_solid.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "flow-server/immersed/cut_cells.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

const Triple n_cells{40, 36, 32};
const Point centre{1.03, 0.87, 0.81};
constexpr double width = 0.05, radius = 0.6;

BodySurface ball(bool is_lumen, bool is_fixed) {
  BodySurface surface = sphere_surface(centre, radius, 5);
  surface.is_lumen = is_lumen;
  surface.is_fixed = is_fixed;
  if (is_lumen)
    for (auto& triangle : surface.triangle) std::swap(triangle[1], triangle[2]);
  return surface;
}

BlockDecomposition one_block(const StretchedGrid& grid) {
  return BlockDecomposition(
      MPI_COMM_SELF, {equal_parts(n_cells[0], 1, 1), equal_parts(n_cells[1], 1, 1), equal_parts(n_cells[2], 1, 1)},
      grid.is_periodic());
}

/// Calls visit(cell, distance of its middle from the centre) for each cell of the box.
template <class Visit>
void for_each_cell(const Visit& visit) {
  for (int k = 0; k < n_cells[2]; ++k)
    for (int j = 0; j < n_cells[1]; ++j)
      for (int i = 0; i < n_cells[0]; ++i)
        visit(Triple{i, j, k},
              std::hypot((i + 0.5) * width - centre[0], (j + 0.5) * width - centre[1], (k + 0.5) * width - centre[2]));
}

TEST(FixedSolid, LiesBehindTheWallByMoreThanAnyoneAsksFor) {
  const StretchedGrid grid = uniform_box(n_cells, width);
  const BlockDecomposition blocks = one_block(grid);
  for (const bool is_lumen : {false, true}) {
    const std::vector<BodySurface> surfaces{ball(is_lumen, true)};
    const FixedSolid solid(grid, blocks, surfaces);
    EXPECT_FALSE(solid.is_empty());
    int n_near = 0, n_far_but_kept = 0;
    for_each_cell([&](const Triple& cell, double distance) {
      const double depth = (is_lumen ? distance - radius : radius - distance) / width;  // behind the wall, in cells
      // A cell that is cut has its middle within half a diagonal, 0.87, of the wall; two more cells stay in each
      // direction: one that is left out has no wall nearer than 2.5 cells, and behind 2.5 diagonals all are left out.
      if (solid.contains(cell) && depth < 2.4) ++n_near;
      if (!solid.contains(cell) && depth > 2.5 * std::numbers::sqrt3 + 0.1) ++n_far_but_kept;
      const Point middle{(cell[0] + 0.5) * width, (cell[1] + 0.5) * width, (cell[2] + 0.5) * width};
      EXPECT_EQ(solid.contains(middle), solid.contains(cell));
    });
    EXPECT_EQ(n_near, 0) << is_lumen;
    EXPECT_EQ(n_far_but_kept, 0) << is_lumen;
  }
}

TEST(FixedSolid, LeavesOutWhatMayBeFluidLater) {
  const StretchedGrid grid = uniform_box(n_cells, width);
  const BlockDecomposition blocks = one_block(grid);
  const auto is_empty = [&](const std::vector<BodySurface>& surfaces) {
    return FixedSolid(grid, blocks, surfaces).is_empty();
  };
  EXPECT_TRUE(is_empty({}));
  EXPECT_TRUE(is_empty({ball(false, false)}));
  BodySurface sheet = flat_sheet({0.5, 0.5, 0.5}, {1, 0, 0}, {0, 1, 0}, 20);
  sheet.is_fixed = true;
  EXPECT_TRUE(is_empty({sheet}));
  // What lies outside of a fixed lumen is inside a moving one now or later.
  EXPECT_TRUE(is_empty({ball(true, true), ball(true, false)}));
  EXPECT_FALSE(is_empty({ball(false, true), ball(true, false)}));
}

}  // namespace
}  // namespace couplet::flow
