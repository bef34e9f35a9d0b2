// bench poisson: the pressure equation on uniform and stretched boxes: time per cell and solve beside the true
// residual.

#include <mpi.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/multigrid.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "flow-server/poisson/pressure_solver.hpp"
#include "proto/report/failure.hpp"
#ifdef HAS_HYPRE
#include "tests/benchmarks/hypre_poisson.hpp"
#endif

namespace {

using namespace couplet::flow;
using Json = nlohmann::ordered_json;

constexpr int n_repeats = 4;

struct Case {
  Triple n{128, 128, 128};
  double stretch = 1;              // of each direction: largest over smallest width
  std::string borders = "closed";  // or periodic; tube: only a tube along x is fluid, open at its
                                   // end; sheet: closed, with a sheet that has a hole
  std::string solver = "multigrid";
  int ranks = 1;
  std::vector<double> tolerances{1e-3, 1e-6};
};

std::vector<Case> all_cases(int n_ranks_most) {
  std::vector<Case> cases;
  const std::vector<Case> grids = {{{128, 128, 128}, 1, "periodic"}, {{128, 128, 128}, 1, "closed"},
                                   {{400, 130, 130}, 6, "closed"},   {{128, 128, 128}, 20, "closed"},
                                   {{256, 256, 256}, 1, "closed"},   {{400, 130, 130}, 1, "tube"},
                                   {{128, 128, 128}, 1, "sheet"}};
  for (const Case& grid : grids)
    for (const char* solver : {"multigrid", "fast_diagonalisation", "hypre_pfmg_cg"})
      for (int ranks = 1; ranks <= n_ranks_most; ranks *= 2) {
        Case one = grid;
        one.solver = solver;
        one.ranks = ranks;
#ifndef HAS_HYPRE
        if (one.solver == "hypre_pfmg_cg") continue;
#endif
        // The peer knows only closed boxes here, and needs too much memory for the largest.
        if (one.solver == "hypre_pfmg_cg" && (one.borders != "closed" || one.n[0] == 256)) continue;
        if (one.solver == "fast_diagonalisation" && (one.borders == "tube" || one.borders == "sheet")) continue;
        if (one.solver == "fast_diagonalisation") one.tolerances = {1e-6};
        cases.push_back(one);
      }
  return cases;
}

std::string text_of(const Case& c) {
  std::ostringstream out;
  out << c.n[0] << ',' << c.n[1] << ',' << c.n[2] << ',' << c.stretch << ',' << c.borders << ',' << c.solver;
  for (const double tolerance : c.tolerances) out << ',' << tolerance;
  return out.str();
}

Case case_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  if (words.size() < 7)
    throw couplet::report::SceneError("--case", "needs nx,ny,nz,stretch,borders,solver,tolerance...");
  Case c{
      {std::stoi(words[0]), std::stoi(words[1]), std::stoi(words[2])}, std::stod(words[3]), words[4], words[5], 1, {}};
  for (std::size_t w = 6; w < words.size(); ++w) c.tolerances.push_back(std::stod(words[w]));
  return c;
}

/// In [-0.5, 0.5), the same for a cell on any number of ranks.
double noise(std::uint64_t number) {
  number = (number + 0x9E3779B97F4A7C15ull) * 0xBF58476D1CE4E5B9ull;
  number ^= number >> 31;
  number *= 0x94D049BB133111EBull;
  number ^= number >> 30;
  return static_cast<double>(number >> 11) / 9007199254740992.0 - 0.5;
}

bool is_in_tube(const StretchedGrid& grid, const Triple& cell) {
  for (int d = 0; d < 3; ++d)
    if (cell[d] < 0 || cell[d] >= grid.n_cells()[d]) return false;
  return std::hypot(grid.axis[1].centre(cell[1]) - 0.5, grid.axis[2].centre(cell[2]) - 0.5) < 0.24;
}

/// Faces between cells of the tube, and those at its end along x.
FaceFractions tube_shares(const StretchedGrid& grid, const BlockDecomposition& blocks) {
  FaceFractions share;
  const Box mine = blocks.mine();
  for (int d = 0; d < 3; ++d) {
    share[d] = Field<float>(mine.sizes(), {1, 1, 1});
    for (int k = -1; k <= mine.size(2); ++k)
      for (int j = -1; j <= mine.size(1); ++j)
        for (int i = -1; i <= mine.size(0); ++i) {
          const Triple before{mine.begin[0] + i, mine.begin[1] + j, mine.begin[2] + k};
          Triple after = before;
          ++after[d];
          const bool is_end = d == 0 && after[0] == grid.n_cells()[0];
          if (is_in_tube(grid, before) && (is_end || is_in_tube(grid, after))) share[d](i, j, k) = 1;
        }
  }
  return share;
}

/// A sheet across x in the middle of cells, with a square hole: shares, further pieces and links of this rank.
void take_sheet(const StretchedGrid& grid, PressureProblem& problem, int layer) {
  constexpr double lower_part = 0.4;  // of a cut cell; the upper part holds its centre
  const Box mine = problem.decomposition->mine(), own = box_of(mine.sizes());
  const Triple n = grid.n_cells();
  const auto is_inside = [&](const Triple& c) { return box_of(n).contains(c); };
  const auto is_cut = [&](const Triple& c) {
    return c[0] == layer && is_inside(c) &&
           (std::abs(c[1] - n[1] / 2) > n[1] / 8 || std::abs(c[2] - n[2] / 2) > n[2] / 8);
  };
  FaceFractions share;
  SplitCells split;
  std::map<Triple, int> piece;  // of cut cells, in indices of the whole
  const auto local = [&](const Triple& c) {
    return Triple{c[0] - mine.begin[0], c[1] - mine.begin[1], c[2] - mine.begin[2]};
  };
  for (Field<float>& field : share) field = Field<float>(mine.sizes(), {1, 1, 1});
  const Box around = mine.grown({1, 1, 1});
  for (int k = around.begin[2]; k < around.end[2]; ++k)
    for (int j = around.begin[1]; j < around.end[1]; ++j)
      if (const Triple c{layer, j, k}; around.contains(c) && is_cut(c)) {
        piece[c] = static_cast<int>(split.cell.size());
        split.cell.push_back(local(c));
      }
  for (int k = around.begin[2]; k < around.end[2]; ++k)
    for (int j = around.begin[1]; j < around.end[1]; ++j)
      for (int i = around.begin[0]; i < around.end[0]; ++i)
        for (int d = 0; d < 3; ++d) {
          const Triple lower{i, j, k}, at = local(lower);
          Triple upper = lower;
          ++upper[d];
          if (!is_inside(lower) || !is_inside(upper) || !around.contains(upper)) continue;
          const double full = grid.volume(lower) / grid.axis[d].width(lower[d]) / grid.axis[d].distance(lower[d]);
          const auto end = [&](const Triple& c, bool is_lower_part) {
            return PressureUnknown{local(c), is_lower_part && is_cut(c) ? piece.at(c) : -1};
          };
          const auto add = [&](double part, bool is_lower_part) {
            const PressureUnknown a = end(lower, is_lower_part), b = end(upper, is_lower_part);
            if (a.piece < 0 && b.piece < 0)
              share[d](at[0], at[1], at[2]) += static_cast<float>(part);
            else if (own.contains(a.cell) || own.contains(b.cell))
              split.links.push_back({a, b, part * full});
          };
          if (d == 0) {
            add(1, upper[0] == layer);
          } else if (is_cut(lower) || is_cut(upper)) {
            add(lower_part, true), add(1 - lower_part, false);
          } else {
            add(1, false);
          }
        }
  problem.open_share = std::move(share);
  problem.split = std::move(split);
}

struct Measured {
  SolveReport report;
  double seconds = 1e30, set_up_seconds = 0,
         update_seconds = 0;  // the fastest of a few: other programs can only slow one down
  std::size_t n_bytes = 0;    // held by the solver on rank 0
  Traffic traffic;            // of rank 0 in one solve
};

Measured measure(const PressureProblem& problem, const std::string& name, const Field<double>& source, double tolerance,
                 Field<double>& phi) {
  Measured measured;
  measured.set_up_seconds = MPI_Wtime();
  const auto solver = make_pressure_solver(
      problem, name == "multigrid" ? PressureMethod::multigrid : PressureMethod::fast_diagonalisation);
  measured.set_up_seconds = MPI_Wtime() - measured.set_up_seconds;
  std::vector<double> piece_source, piece_phi;
  if (problem.split) {
    piece_source.assign(problem.split->cell.size(), 0.0), piece_phi = piece_source;
    // A sheet that moves changes the cells on both sides of it.
    const int begin = problem.split->cell.empty() ? 0 : problem.split->cell.front()[0];
    Box changed = box_of(problem.decomposition->mine().sizes()).grown({1, 1, 1});
    changed.begin[0] = begin - 1, changed.end[0] = begin + 2;
    measured.update_seconds = 1e30;
    for (int repeat = 0; repeat < n_repeats; ++repeat) {
      MPI_Barrier(MPI_COMM_WORLD);
      const double start = MPI_Wtime();
      solver->update(std::span(&changed, 1));
      MPI_Barrier(MPI_COMM_WORLD);
      measured.update_seconds = std::min(measured.update_seconds, MPI_Wtime() - start);
    }
  }
  SolveLimits limits;
  limits.relative = tolerance;
  for (int repeat = 0; repeat < n_repeats; ++repeat) {
    std::fill(phi.data(), phi.data() + phi.n_values(), 0.0);
    const Traffic before = solver->traffic();
    MPI_Barrier(MPI_COMM_WORLD);
    const double start = MPI_Wtime();
    std::fill(piece_phi.begin(), piece_phi.end(), 0.0);
    measured.report = solver->solve(source, phi, limits, piece_source, piece_phi);
    MPI_Barrier(MPI_COMM_WORLD);
    measured.seconds = std::min(measured.seconds, MPI_Wtime() - start);
    measured.traffic = solver->traffic() - before;
  }
  measured.n_bytes = solver->n_bytes();
  return measured;
}

#ifdef HAS_HYPRE
Measured measure_hypre(const PressureProblem& problem, const Field<double>& source, double tolerance,
                       Field<double>& phi) {
  const BlockDecomposition& blocks = *problem.decomposition;
  const HypreReport hypre = solve_with_hypre(*problem.grid, blocks, source, tolerance, 2, phi);
  Measured measured;
  measured.seconds = hypre.seconds, measured.set_up_seconds = hypre.set_up_seconds;
  measured.report.iterations = hypre.iterations;
  // Its residual by the same ruler as ours.
  HaloExchange(blocks).exchange<double>({&phi}, 1);
  const PressureOperator div_grad(problem);
  double sums[3] = {div_grad.residual(source, 0, phi, nullptr), div_grad.moments(source)[1], div_grad.volume()};
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  measured.report.true_residual = std::sqrt(sums[0] / sums[2]),
  measured.report.source_norm = std::sqrt(sums[1] / sums[2]);
  return measured;
}
#else
Measured measure_hypre(const PressureProblem&, const Field<double>&, double, Field<double>&) {
  throw couplet::report::SceneError("--case", "hypre was not found when this was built",
                                    "install libhypre-dev, build again");
}
#endif

/// Solves one case on the ranks of MPI_COMM_WORLD; rank 0 returns the rows.
std::vector<Json> solve_case(const Case& c) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const auto axis = [&](int d) {
    const double length = static_cast<double>(c.n[d]) / c.n[1];
    return StretchedAxis(symmetrically_stretched_faces(0, length, c.n[d], c.stretch), c.borders == "periodic");
  };
  const StretchedGrid grid{{axis(0), axis(1), axis(2)}, 3};
  PressureProblem problem;
  problem.grid = &grid;
  const BlockDecomposition blocks(MPI_COMM_WORLD, suitable_partitions(grid, choose_shape(c.n, n_ranks)),
                                  grid.is_periodic());
  problem.decomposition = &blocks;
  const Box mine = blocks.mine();
  if (c.borders == "tube") problem.open_share = tube_shares(grid, blocks);
  if (c.borders == "sheet") take_sheet(grid, problem, c.n[0] / 2);
  Field<double> source(mine.sizes(), {0, 0, 0}), phi(mine.sizes(), {1, 1, 1});
  double sums[2] = {0, 0};
  const auto for_all = [&](const auto& visit) {
    for (int k = mine.begin[2]; k < mine.end[2]; ++k)
      for (int j = mine.begin[1]; j < mine.end[1]; ++j)
        for (int i = mine.begin[0]; i < mine.end[0]; ++i)
          visit(source(i - mine.begin[0], j - mine.begin[1], k - mine.begin[2]), Triple{i, j, k});
  };
  for_all([&](double& value, const Triple& cell) {
    const double x = grid.axis[0].centre(cell[0]) / grid.axis[0].length(), y = grid.axis[1].centre(cell[1]),
                 z = grid.axis[2].centre(cell[2]);
    value =
        std::cos(M_PI * x) * std::cos(2 * M_PI * y) * std::cos(M_PI * z) + 0.5 * std::sin(7 * x + 3 * y) * z +
        noise(static_cast<std::uint64_t>((static_cast<std::int64_t>(cell[2]) * c.n[1] + cell[1]) * c.n[0] + cell[0]));
    sums[0] += value * grid.volume(cell), sums[1] += grid.volume(cell);
  });
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  if (c.borders != "tube") for_all([&](double& value, const Triple&) { value -= sums[0] / sums[1]; });

  auto n_cells = static_cast<double>(PressureOperator(problem).active().n_cells());
  MPI_Allreduce(MPI_IN_PLACE, &n_cells, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  std::vector<Json> rows;
  for (const double tolerance : c.tolerances) {
    const Measured measured = c.solver == "hypre_pfmg_cg" ? measure_hypre(problem, source, tolerance, phi)
                                                          : measure(problem, c.solver, source, tolerance, phi);
    const double residual = measured.report.true_residual / measured.report.source_norm;
    rows.push_back({{"nx", c.n[0]},
                    {"ny", c.n[1]},
                    {"nz", c.n[2]},
                    {"stretch", c.stretch},
                    {"borders", c.borders},
                    {"ranks", n_ranks},
                    {"solver", c.solver},
                    {"tolerance", tolerance},
                    {"iterations", measured.report.iterations},
                    {"true_residual", residual},
                    {"ns_per_cell", 1e9 * measured.seconds / n_cells},
                    {"update_ns_per_cell", 1e9 * measured.update_seconds / n_cells},
                    {"set_up_ns_per_cell", 1e9 * measured.set_up_seconds / n_cells},
                    {"iterations_per_decade", measured.report.iterations / -std::log10(std::max(1e-300, residual))},
                    {"bytes_per_cell", static_cast<double>(measured.n_bytes) * n_ranks / n_cells},
                    {"messages_per_rank", measured.traffic.messages},
                    {"bytes_per_rank", measured.traffic.bytes},
                    {"reductions", measured.traffic.reductions}});
  }
  return rank == 0 ? rows : std::vector<Json>{};
}

void print(const Json& row) {
  std::printf("%4d %4d %4d %7g %9s %5d %-21s %9g %5d %13.1e %11.1f %11.1f %6.2f %10.1f\n", row["nx"].get<int>(),
              row["ny"].get<int>(), row["nz"].get<int>(), row["stretch"].get<double>(),
              row["borders"].get<std::string>().c_str(), row["ranks"].get<int>(),
              row["solver"].get<std::string>().c_str(), row["tolerance"].get<double>(), row["iterations"].get<int>(),
              row["true_residual"].get<double>(), row["ns_per_cell"].get<double>(),
              row["set_up_ns_per_cell"].get<double>(), row["iterations_per_decade"].get<double>(),
              row["bytes_per_cell"].get<double>());
  std::fflush(stdout);
}

void write_json(const std::vector<Json>& rows, const std::string& path) {
  std::ofstream file(path);
  file << Json(rows).dump(2) << '\n';
  if (!file) throw couplet::report::FileError(path, "cannot be written");
}

/// Runs this program again under mpirun for one case and reads what it wrote.
std::vector<Json> start_case(const std::string& program, const Case& c) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("bench-poisson-" + std::to_string(getpid()) + ".json");
  const std::string command = "mpirun --oversubscribe --bind-to none -n " + std::to_string(c.ranks) + " '" + program +
                              "' --case " + text_of(c) + " --json '" + file.string() + "'";
  if (std::system(command.c_str()) != 0)
    throw couplet::report::NumericsError("bench poisson", "the case " + text_of(c) + " failed");
  std::ifstream in(file);
  const Json rows = Json::parse(in);
  std::filesystem::remove(file);
  return rows.get<std::vector<Json>>();
}

int run(int argc, char** argv) {
  const std::string about = "the pressure equation on boxes, uniform and stretched: time per cell beside true residual";
  CLI::App app(about);
  std::string json, one_case;
  bool says_about = false;
  int n_ranks_most = 2;
  app.add_option("--json", json, "write the rows there");
  app.add_option("--ranks", n_ranks_most, "measure with 1, 2, 4 ... ranks up to this");
  app.add_option(
      "--case", one_case,
      "nx,ny,nz,stretch,borders (closed, periodic, tube),solver,tolerance...: one case, on the ranks of this mpirun");
  app.add_flag("--about", says_about, "say in one line what is measured");
  CLI11_PARSE(app, argc, argv);
  if (says_about) {
    std::printf("%s\n", about.c_str());
    return 0;
  }
  std::vector<Json> rows;
  if (!one_case.empty()) {
    MPI_Init(&argc, &argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    rows = solve_case(case_of(one_case));
    for (const Json& row : rows) print(row);
    if (!json.empty() && rank == 0) write_json(rows, json);
    MPI_Finalize();
    return 0;
  }
#ifndef HAS_HYPRE
  std::printf("hypre was not found when this was built: its rows are left out\n");
#endif
  std::printf("%4s %4s %4s %7s %9s %5s %-21s %9s %5s %13s %11s %11s %6s %10s\n", "nx", "ny", "nz", "stretch", "borders",
              "ranks", "solver", "tolerance", "it", "true_residual", "ns_per_cell", "set_up", "it/dec", "bytes/cell");
  std::fflush(stdout);
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
  const std::string program = std::filesystem::canonical("/proc/self/exe").string();
  for (const Case& c : all_cases(n_ranks_most))
    for (Json& row : start_case(program, c)) rows.push_back(std::move(row));
  if (!json.empty()) write_json(rows, json);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench poisson", run, argc, argv);
}
