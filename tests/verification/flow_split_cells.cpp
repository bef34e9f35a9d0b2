// The pressure equation where thin sheets cut cells into pieces: exactness, update, convergence. Started on 1 and 2
// ranks.

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>

#include "tests/verification/split_solution.hpp"

namespace couplet::flow {
namespace {

/// All unknowns of a box with what connects them: the matrix - volume * div grad, assembled without the solver.
struct WholeMatrix {
  std::map<GridUnknown, int> row;
  Eigen::SparseMatrix<double> matrix;
  Eigen::VectorXd volume;

  explicit WholeMatrix(const SheetGeometry& geometry, int n_dimensions) {
    const Triple n = geometry.grid().n_cells();
    std::vector<SheetGeometry::Connection> all;
    for (int k = n_dimensions == 3 ? -1 : 0; k < n[2]; ++k)
      for (int j = -1; j < n[1]; ++j)
        for (int i = -1; i < n[0]; ++i) {
          const Triple cell{i, j, k};
          int n_outside = 0, outside = -1;
          for (int d = 0; d < 3; ++d)
            if (cell[d] < 0) ++n_outside, outside = d;
          if (n_outside > 1) continue;
          if (n_outside == 0)
            for (const auto& one : geometry.inner_connections(cell)) all.push_back(one);
          for (int d = 0; d < n_dimensions; ++d) {
            if (n_outside == 1 && (d != outside || geometry.is_inside(cell))) continue;
            for (const auto& one : geometry.connections(cell, d)) all.push_back(one);
          }
        }
    for (auto& one : all)
      for (GridUnknown* end : {&one.a, &one.b})
        if (geometry.is_inside(end->cell)) {
          end->cell = geometry.wrapped(end->cell);
          row.emplace(*end, 0);
        }
    int count = 0;
    for (auto& [unknown, number] : row) number = count++;
    volume.resize(count);
    for (const auto& [unknown, number] : row) volume[number] = geometry.grid().volume(unknown.cell);
    std::vector<Eigen::Triplet<double>> entries;
    for (auto& one : all) {
      const bool has_a = geometry.is_inside(one.a.cell), has_b = geometry.is_inside(one.b.cell);
      // The solver's shares have single precision.
      if (one.a.number == 0 && one.b.number == 0 && one.direction >= 0)
        one.conductance *= static_cast<double>(static_cast<float>(one.share)) / one.share;
      if (has_a) entries.emplace_back(row.at(one.a), row.at(one.a), one.conductance);
      if (has_b) entries.emplace_back(row.at(one.b), row.at(one.b), one.conductance);
      if (!has_a || !has_b) continue;
      entries.emplace_back(row.at(one.a), row.at(one.b), -one.conductance);
      entries.emplace_back(row.at(one.b), row.at(one.a), -one.conductance);
    }
    matrix.resize(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& source) const {
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    return factors.solve(-(volume.array() * source.array()).matrix());
  }
};

TEST(SplitCells, SolutionsAreThoseOfTheWholeMatrix) {
  for (const auto& [n_dimensions, is_periodic] : {std::pair(2, false), {2, true}, {3, false}, {3, true}})
    for (auto [name, box] : sheets(n_dimensions == 2 ? 24 : 12, n_dimensions, 2)) {
      box.is_periodic[1] = is_periodic;
      if (is_periodic && box.normal[1] != 0) continue;  // a sheet that does not close
      const SplitSolution solution(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-12, 0, 200});
      const WholeMatrix whole(solution.geometry, n_dimensions);
      Eigen::VectorXd source(whole.volume.size());
      const auto sources = divergence(solution.geometry, n_dimensions, solution.blocks.all());
      for (const auto& [unknown, row] : whole.row) source[row] = sources.at(unknown);
      const Eigen::VectorXd exact = whole.solve(source);
      double difference = 0;
      for (const auto& [unknown, value] : solution.values())
        difference = std::max(difference, std::abs(value - exact[whole.row.at(unknown)]));
      // A residual of 1e-12 of the source, times the condition of the matrix.
      EXPECT_LT(difference, 1e-10 * exact.lpNorm<Eigen::Infinity>()) << name << (is_periodic ? ", periodic" : "");
    }
}

TEST(SplitCells, AMovingSheetThatIsUpdatedIsThatOfANewSolver) {
  SplitBox box = sheets(32, 2, 1)[0].second;
  box.normal = {1, 0.3, 0};
  box.offset = {0.31};
  box.is_cut = [](double, double y, double) { return std::abs(y - 0.4) > 0.06; };
  SplitSolution moving(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-10, 0, 60});
  int most = 0;
  for (int position = 0; position < 50; ++position) {
    box.offset = {0.31 + 0.0153 * position};
    moving.box = box;
    moving.geometry = SheetGeometry(box);
    moving.take_sheets();
    moving.set_source();
    const Box all = box_of(moving.blocks.mine().sizes());
    moving.solver->update(std::span(&all, 1));
    std::fill(moving.phi.data(), moving.phi.data() + moving.phi.n_values(), 0.0);
    moving.report =
        moving.solver->solve(moving.source, moving.phi, {1e-10, 0, 60}, moving.piece_source, moving.piece_phi);
    const SplitSolution fresh(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-10, 0, 60});
    ASSERT_EQ(moving.report.iterations, fresh.report.iterations) << position;
    ASSERT_EQ(moving.values(), fresh.values()) << position;
    most = std::max(most, moving.report.iterations);
  }
  EXPECT_LE(most, 17);  // wherever the sheet lies in the cells; 8 without it
}

TEST(SplitCells, AnyNumberOfPiecesInACellIsSmoothed) {
  for (const int n_sheets : {6, 7, 8, 15, 20})
    for (const double conductance : {0.0, 1e-3, 1e3}) {
      SplitBox box = sheets(24, 2, 1)[0].second;
      box.normal = {1, 0.2, 0};
      for (int s = 0; s < n_sheets; ++s) box.offset.push_back(0.57 + 0.8 / 24 * s / n_sheets);
      box.is_cut = [](double, double y, double) { return std::abs(y - 0.4) > 0.06; };
      box.edge_conductance = conductance;
      const SplitSolution solution(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-9, 0, 100});
      EXPECT_LT(solution.report.true_residual, 1.1e-9 * solution.report.source_norm);
      // Gaps as wide as a fraction of a cell, whatever the fraction: 7 to 17 with up to 7 sheets.
      EXPECT_LE(solution.report.iterations, 20) << n_sheets << " sheets, " << conductance;
    }
}

TEST(SplitCells, ASheetCostsLessThanAsManyIterationsAgain) {
  for (const int n_dimensions : {2, 3})
    for (const double stretching : {1.0, 6.0}) {
      int n_without = 0;
      for (auto [name, box] : sheets(n_dimensions == 2 ? 80 : 32, n_dimensions, stretching)) {
        const SplitSolution solution(box, MPI_COMM_WORLD, shape_of_ranks(), {1e-8, 0, 60});
        if (name == "none") n_without = solution.report.iterations;
        // Two sheets in one layer of cells leave a channel that is thinner than any cell of coarse levels.
        const int allowed = name.starts_with("two") ? 5 * n_without : 2 * n_without + 2;
        EXPECT_LE(solution.report.iterations, allowed) << name << ", stretched " << stretching;
      }
    }
}

}  // namespace
}  // namespace couplet::flow
