#pragma once
// The pressure equation in a box with sheets, solved on the ranks of a test.

#include <mpi.h>

#include <memory>
#include <string>
#include <utility>

#include "flow-server/poisson/multigrid.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "tests/verification/split_box.hpp"

namespace couplet::flow {

inline int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

inline Triple shape_of_ranks() {
  return n_ranks() == 4 ? Triple{2, 2, 1} : Triple{1, n_ranks(), 1};
}

/// The divergence of a rough velocity: small pieces have small sources, as in a flow.
inline std::map<GridUnknown, double> divergence(const SheetGeometry& geometry, int n_dimensions, const Box& cells) {
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

inline std::vector<double> stretched(int n, double stretching, double length = 1) {
  return symmetrically_stretched_faces(0, length, n, stretching);
}

/// Sheets of every kind in a box of n cells a direction, open at both ends along x.
inline std::vector<std::pair<std::string, SplitBox>> sheets(int n, int n_dimensions, double stretching) {
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

}  // namespace couplet::flow
