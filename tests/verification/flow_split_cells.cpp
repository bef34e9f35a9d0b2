// The pressure equation where thin sheets cut cells into pieces: exactness, invariance over ranks, convergence.
// Started on 1, 2, 3 and 4 ranks.

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>

#include "flow-server/poisson/multigrid.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "tests/verification/split_box.hpp"

namespace couplet::flow {
namespace {

int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

Triple shape_of_ranks() {
  return n_ranks() == 4 ? Triple{2, 2, 1} : Triple{1, n_ranks(), 1};
}

/// The divergence of a rough velocity: small pieces have small sources, as in a flow.
std::map<GridUnknown, double> divergence(const SheetGeometry& geometry, int n_dimensions, const Box& cells) {
  const StretchedGrid& grid = geometry.grid();
  std::map<GridUnknown, double> sums;
  const auto add = [&](const SheetGeometry::Connection& one, const Triple& cell) {
    const Triple at = geometry.wrapped(one.a.cell);
    const int seed = at[0] + 1 + 131 * (at[1] + 1) + 17161 * (at[2] + 1);
    const double velocity = 0.3 + std::sin(0.05 * at[0] + 0.1 * at[1]) + std::cos(0.07 * at[1] - 0.2 * at[2]) +
                            std::sin(7.0 * seed + 3.0 * one.direction + 11.0 * one.a.number + 5.0 * one.b.number);
    const double flux = one.share * grid.volume(cell) / grid.axis[one.direction].width(cell[one.direction]) * velocity;
    if (geometry.wrapped(one.a.cell) == cell && geometry.is_inside(one.a.cell))
      sums[{cell, one.a.number}] += flux / grid.volume(cell);
    if (geometry.wrapped(one.b.cell) == cell && geometry.is_inside(one.b.cell))
      sums[{cell, one.b.number}] -= flux / grid.volume(cell);
  };
  for (int k = cells.begin[2]; k < cells.end[2]; ++k)
    for (int j = cells.begin[1]; j < cells.end[1]; ++j)
      for (int i = cells.begin[0]; i < cells.end[0]; ++i)
        for (int d = 0; d < n_dimensions; ++d)
          for (const int lower : {1, 0}) {
            Triple face{i, j, k};
            face[d] -= lower;
            for (const auto& one : geometry.connections(face, d)) add(one, {i, j, k});
          }
  return sums;
}

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

/// A problem with sheets on one sharing among ranks.
class SplitSolution {
 public:
  SplitSolution(const SplitBox& given, MPI_Comm communicator, const Triple& shape, const SolveLimits& limits,
                bool is_aligned = true)
      : box(given),
        geometry(box),
        grid(box.grid()),
        blocks(communicator,
               is_aligned ? suitable_partitions(grid, shape)
                          : std::array<Partition, 3>{equal_parts(grid.n_cells()[0], shape[0], 1),
                                                     equal_parts(grid.n_cells()[1], shape[1], 1),
                                                     equal_parts(grid.n_cells()[2], shape[2], 1)},
               grid.is_periodic()),
        source(blocks.mine().sizes(), {0, 0, 0}),
        phi(blocks.mine().sizes(), {1, 1, box.n_dimensions == 3}) {
    problem.grid = &grid;
    problem.decomposition = &blocks;
    take_sheets();
    solver = make_pressure_solver(problem, PressureMethod::multigrid);
    set_source();
    report = solver->solve(source, phi, limits, piece_source, piece_phi);
  }
  void take_sheets() {
    SplitBlock block = split_block(geometry, box, blocks.mine());
    problem.open_share = std::move(block.share);
    problem.split = std::move(block.split);
    name = std::move(block.name);
  }
  void set_source() {
    const std::map<GridUnknown, double> values = divergence(geometry, box.n_dimensions, blocks.mine());
    const auto at = [&](const GridUnknown& unknown) {
      const auto found = values.find(unknown);
      return found == values.end() ? 0 : found->second;
    };
    for_cells([&](const Triple& local, const Triple& cell) { source(local[0], local[1], local[2]) = at({cell, 0}); });
    piece_source.clear();
    for (const GridUnknown& one : name) piece_source.push_back(at(one));
    piece_phi.assign(name.size(), 0.0);
  }
  void for_cells(const std::function<void(const Triple& local, const Triple& global)>& visit) const {
    const Box& mine = blocks.mine();
    for (int k = mine.begin[2]; k < mine.end[2]; ++k)
      for (int j = mine.begin[1]; j < mine.end[1]; ++j)
        for (int i = mine.begin[0]; i < mine.end[0]; ++i)
          visit({i - mine.begin[0], j - mine.begin[1], k - mine.begin[2]}, {i, j, k});
  }
  /// Value of each unknown on this rank, ghost pieces included.
  std::map<GridUnknown, double> values() const {
    std::map<GridUnknown, double> all;
    for_cells([&](const Triple& local, const Triple& cell) { all[{cell, 0}] = phi(local[0], local[1], local[2]); });
    for (std::size_t p = 0; p < name.size(); ++p) all[name[p]] = piece_phi[p];
    return all;
  }

  SplitBox box;
  SheetGeometry geometry;
  StretchedGrid grid;
  BlockDecomposition blocks;
  PressureProblem problem;
  std::vector<GridUnknown> name;
  Field<double> source, phi;
  std::vector<double> piece_source, piece_phi;
  std::unique_ptr<PressureSolver> solver;
  SolveReport report;
};

std::vector<double> stretched(int n, double stretching, double length = 1) {
  return symmetrically_stretched_faces(0, length, n, stretching);
}

/// Sheets of every kind in a box of n cells a direction, open at both ends along x.
std::vector<std::pair<std::string, SplitBox>> sheets(int n, int n_dimensions, double stretching) {
  SplitBox none{{stretched(n, stretching), stretched(n, stretching),
                 n_dimensions == 3 ? stretched(n, stretching) : std::vector<double>{0, 0.1}},
                n_dimensions};
  none.border_is_open[0] = {true, true};
  std::vector<std::pair<std::string, SplitBox>> all{{"none", none}};
  const std::vector<double>& x = none.faces[0];
  const auto plane = [&](double at, int odd) {
    const auto cell = static_cast<std::size_t>(n / 2 - 2 + odd);
    SplitBox box = none;
    box.offset = {x[cell] + at * (x[cell + 1] - x[cell])};
    return box;
  };
  const auto hole = [n_dimensions](double, double y, double z) {
    return std::abs(y - 0.4) > 0.02 || (n_dimensions == 3 && std::abs(z - 0.6) > 0.02);
  };
  for (const int odd : {0, 1}) {
    const std::string name = odd ? ", odd" : ", even";
    all.emplace_back("normal 0.5" + name, plane(0.5, odd));
    all.emplace_back("normal 1e-6" + name, plane(1e-6, odd));
    all.emplace_back("normal 1 - 1e-6" + name, plane(1 - 1e-6, odd));
    SplitBox with_hole = plane(0.3, odd);
    with_hole.is_cut = hole;
    all.emplace_back("hole" + name, with_hole);
  }
  SplitBox oblique = none;
  oblique.normal = {1, 0.7, n_dimensions == 3 ? 0.4 : 0.0};
  oblique.offset = {1.03};
  all.emplace_back("oblique", oblique);
  oblique.is_cut = hole;
  all.emplace_back("oblique with hole", oblique);
  oblique.is_cut = {};
  oblique.offset = {1.03, 1.03 + 0.3 / n};
  all.emplace_back("two oblique", oblique);
  SplitBox two = plane(0.3, 0);
  two.offset.push_back(two.offset[0] + 0.4 / n);
  two.is_cut = hole;
  all.emplace_back("two with hole", two);
  for (const double conductance : {1e-8, 1.0, 1e3}) {
    SplitBox leaky = plane(0.4, 1);
    leaky.edge_conductance = conductance;
    all.emplace_back("leaky " + std::to_string(conductance), leaky);
  }
  return all;
}

TEST(SplitCells, SolutionsAreThoseOfTheWholeMatrix) {
  if (n_ranks() > 2) GTEST_SKIP() << "on one and two ranks";
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

TEST(SplitCells, AMovingSheetThatIsUpdatedIsThatOfANewSolver) {
  if (n_ranks() > 2) GTEST_SKIP() << "on one and two ranks";
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

TEST(SplitCells, AnyNumberOfPiecesInACellIsSmoothed) {
  if (n_ranks() > 2) GTEST_SKIP() << "on one and two ranks";
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
  if (n_ranks() > 2) GTEST_SKIP() << "on one and two ranks";
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
