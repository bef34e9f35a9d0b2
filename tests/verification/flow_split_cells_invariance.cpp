// The same on any number of ranks: solutions, means of sealed parts, the update where sheets have moved. Started on 1,
// 2, 3 and 4 ranks.

#include <gtest/gtest.h>

#include "tests/verification/split_solution.hpp"

namespace couplet::flow {
namespace {

TEST(SplitCells, EachSealedPartHasItsOwnMean) {
  for (const int n_dimensions : {2, 3})
    for (const double right : {0.55, 0.92}) {
      // Closed but for one end: two sheets across seal a pocket and, or, the other end.
      SplitBox box = sheets(n_dimensions == 2 ? 32 : 16, n_dimensions, 1)[0].second;
      box.border_is_open[0] = {true, false};
      box.normal = {1, 0.3, 0};
      box.offset = {0.53, 0.23 + right};
      SplitSolution solution(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-10, 0, 60});
      // A divergence has no defect in a sealed part, to round-off; 1 everywhere has the number of cells there.
      EXPECT_LT(solution.report.largest_defect, 1e-12) << right;
      solution.for_cells([&](const Triple& at, const Triple&) { solution.source(at[0], at[1], at[2]) += 1; });
      const SolveReport with_defect = solution.solver->solve(solution.source, solution.phi, {1e-10, 0, 60},
                                                             solution.piece_source, solution.piece_phi);
      EXPECT_GT(with_defect.largest_defect, 0.05 * solution.grid.axis[2].length());
      EXPECT_LT(with_defect.true_residual, 1.1e-10 * with_defect.source_norm);
    }
}

TEST(SplitCells, EachRankCountAndShapeGivesTheSolutionOfOneRank) {
  for (const int n_dimensions : {2, 3})
    for (const bool is_aligned : {true, false})
      for (auto [name, box] : sheets(n_dimensions == 2 ? 36 : 20, n_dimensions, 2)) {
        if (n_ranks() == 1 && !is_aligned) continue;
        // More ranks than cores wait for each other.
        if (n_ranks() > 2 && !name.starts_with("hole") && !name.starts_with("two with hole")) continue;
        box.is_periodic[1] = true;
        if (box.normal[1] != 0) continue;
        const SplitSolution alone(box, MPI_COMM_SELF, {1, 1, 1}, {1e-11, 0, 100});
        const SplitSolution shared(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-11, 0, 100}, is_aligned);
        EXPECT_EQ(shared.report.iterations, alone.report.iterations) << name;
        const std::map<GridUnknown, double> exact = alone.values();
        double difference = 0, largest = 0;
        for (const auto& [unknown, value] : shared.values()) {
          difference = std::max(difference, std::abs(value - exact.at(unknown)));
          largest = std::max(largest, std::abs(value));
        }
        // The same arithmetic everywhere but for the ends of rows, where compilers may fuse other products.
        EXPECT_LE(difference, 1e-12 * largest) << name;
      }
}

/// Closes the faces of cells with their centre in a ball, those to cells outside it to some degree.
void place_ball(SplitSolution& solution, const std::array<double, 3>& centre, double radius) {
  const StretchedGrid& grid = solution.grid;
  const Triple origin = solution.blocks.mine().begin, sizes = solution.blocks.mine().sizes();
  const auto is_in_ball = [&](const Triple& given) {
    if (!solution.geometry.is_inside(given)) return false;
    const Triple cell = solution.geometry.wrapped(given);
    double square = 0;
    for (int d = 0; d < 3; ++d) square += std::pow(grid.axis[d].centre(cell[d]) - centre[d], 2);
    return square < radius * radius;
  };
  for (int d = 0; d < 3; ++d)
    for (int k = -1; k <= sizes[2]; ++k)
      for (int j = -1; j <= sizes[1]; ++j)
        for (int i = -1; i <= sizes[0]; ++i) {
          const Triple lower{origin[0] + i, origin[1] + j, origin[2] + k};
          Triple upper = lower;
          ++upper[d];
          const bool below = is_in_ball(lower), above = is_in_ball(upper);
          float& share = (*solution.problem.open_share)[d](i, j, k);
          if (below && above) share = 0;
          if (below != above) share *= lower[0] % 2 == 0 ? 0.0f : 0.07f;  // closed or weak
        }
}

/// One box for each face whose share is another: what a flow with moving bodies reports.
std::vector<Box> changed_faces(const FaceFractions& before, const FaceFractions& now) {
  std::vector<Box> changed;
  for (int d = 0; d < 3; ++d)
    for (int k = -1; k <= now[d].sizes()[2]; ++k)
      for (int j = -1; j <= now[d].sizes()[1]; ++j)
        for (int i = -1; i <= now[d].sizes()[0]; ++i)
          if (before[d](i, j, k) != now[d](i, j, k)) {
            Box box{{i, j, k}, {i + 1, j + 1, k + 1}};
            ++box.end[d];
            changed.push_back(box);
          }
  return changed;
}

TEST(SplitCells, AMovingBallThatIsUpdatedIsThatOfANewSolver) {
  // Cells become active and inactive; the ball crosses borders of blocks and of the grid and is gone in the end. Sheets
  // come and go, with holes, leaky, or sealing parts of the fluid.
  struct Variant {
    bool is_periodic, is_aligned;
    std::array<bool, 2> is_open;
    double stretching;
    std::vector<double> sheets;
  };
  std::vector<Variant> variants{{true, true, {true, true}, 2, {}},
                                {false, false, {false, false}, 1, {}},
                                {true, true, {true, false}, 2, {0.37, 0.55}},
                                {true, false, {true, true}, 1, {0.41}},
                                {false, true, {false, false}, 2, {0.5, 0.51}}};
  if (n_ranks() > 2) variants = {variants[3]};  // more ranks than cores wait for each other
  for (const Variant& variant : variants) {
    SplitBox box = sheets(16, 3, variant.stretching)[0].second;
    box.is_periodic[1] = variant.is_periodic;
    box.border_is_open[0] = variant.is_open;
    if (!variant.is_aligned) box.is_cut = [](double, double y, double) { return std::abs(y - 0.4) > 0.1; };
    SplitSolution moving(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-9, 0, 60}, variant.is_aligned);
    int n_active_before = -1, n_moves = 0;
    const int n_positions = n_ranks() > 2 ? 3 : 9;
    for (int position = 0; position < n_positions; ++position) {
      moving.box = box;
      if (position % 4 != 3)
        for (const double offset : variant.sheets) moving.box.offset.push_back(offset + 0.013 * position);
      if (position % 4 == 1) moving.box.edge_conductance = 1e-3;
      moving.geometry = SheetGeometry(moving.box);
      const FaceFractions before = std::move(*moving.problem.open_share);
      moving.take_sheets();
      place_ball(moving, {0.1 + 0.14 * position, 0.5 + 0.08 * position, 0.45}, 0.2);
      moving.set_source();
      moving.solver->update(changed_faces(before, *moving.problem.open_share));
      const auto solved = [&](PressureSolver& solver) {
        std::fill(moving.phi.data(), moving.phi.data() + moving.phi.n_values(), 0.0);
        std::fill(moving.piece_phi.begin(), moving.piece_phi.end(), 0.0);
        moving.report = solver.solve(moving.source, moving.phi, {1e-9, 0, 60}, moving.piece_source, moving.piece_phi);
        return moving.values();
      };
      const std::map<GridUnknown, double> updated = solved(*moving.solver);
      const SolveReport report = moving.report;
      const auto fresh = make_pressure_solver(moving.problem, PressureMethod::multigrid);
      ASSERT_EQ(updated, solved(*fresh)) << position;
      ASSERT_EQ(report.iterations, moving.report.iterations) << position;
      ASSERT_EQ(report.largest_defect, moving.report.largest_defect) << position;
      const int n_active = static_cast<int>(PressureOperator(moving.problem).active().n_cells());
      n_moves += n_active != n_active_before ? 1 : 0;
      n_active_before = n_active;
    }
    EXPECT_GE(n_moves, n_ranks() == 1 ? 5 : 0);  // the test has seen rows change
  }
}

}  // namespace
}  // namespace couplet::flow
