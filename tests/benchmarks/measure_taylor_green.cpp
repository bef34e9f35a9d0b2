// Steps of the Taylor-Green vortex on the ranks of one job; prints one object of JSON. Driven by taylor_green.py and
// flow_scaling.py.

#include <mpi.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "flow-server/navier_stokes/fractional_step.hpp"
#include "proto/report/failure.hpp"

namespace {

using namespace couplet::flow;

struct Options {
  int n = 64;
  std::vector<int> shape;
  int steps = 20;
  double step = 0;  // [s]; 0: a Courant number of 0.25, at the start
  double tolerance = 1e-3;
  std::string scheme = "adams_bashforth";
  std::string pressure = "automatic";
};

const std::map<std::string, TimeScheme> schemes{{"automatic", TimeScheme::automatic},
                                                {"adams_bashforth", TimeScheme::adams_bashforth},
                                                {"runge_kutta", TimeScheme::runge_kutta},
                                                {"crank_nicolson", TimeScheme::crank_nicolson}};
const std::map<std::string, PressureMethod> pressure_methods{
    {"automatic", PressureMethod::automatic},
    {"multigrid", PressureMethod::multigrid},
    {"fast_diagonalisation", PressureMethod::fast_diagonalisation}};

/// u = sin x cos y cos z, v = -cos x sin y cos z in a periodic box of 2 pi, Re = 1600.
NavierStokesSetup taylor_green(const Options& options) {
  const StretchedAxis axis(uniform_faces(0, 2 * std::numbers::pi, options.n), true);
  NavierStokesSetup setup{{{axis, axis, axis}, 3},    1,  1.0 / 1600, {},   {}, {}, {}, {},
                          schemes.at(options.scheme), {}, {},         false};
  setup.initial_velocity[0] =
      SpaceTimeValue::Function([](const Point& x, double) { return std::sin(x[0]) * std::cos(x[1]) * std::cos(x[2]); });
  setup.initial_velocity[1] = SpaceTimeValue::Function(
      [](const Point& x, double) { return -std::cos(x[0]) * std::sin(x[1]) * std::cos(x[2]); });
  setup.pressure.method = pressure_methods.at(options.pressure);
  setup.pressure.relative_tolerance = options.tolerance;
  setup.pressure.divergence_tolerance = 0;
  return setup;
}

double kinetic_energy(const FlowState& state, int n) {
  double sum = 0;
  for (const auto& component : state.velocity) {
    const Triple size = component.sizes();
    for (int k = 0; k < size[2]; ++k)
      for (int j = 0; j < size[1]; ++j)
        for (int i = 0; i < size[0]; ++i) sum += component(i, j, k) * component(i, j, k);
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return 0.5 * sum / std::pow(n, 3);
}

double bytes_of(const FlowState& state) {
  double bytes = static_cast<double>(state.pressure.n_bytes());
  for (const auto& field : state.velocity) bytes += static_cast<double>(field.n_bytes());
  for (const auto& field : state.rate) bytes += static_cast<double>(field.n_bytes());
  return bytes;
}

double summed(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

double largest(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  return value;
}

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

int measure(const Options& options) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const double memory_before = summed(peak_memory());
  const NavierStokesSetup setup = taylor_green(options);
  const Triple n_cells = setup.grid.n_cells();
  const Triple shape = options.shape.size() == 3 ? Triple{options.shape[0], options.shape[1], options.shape[2]}
                                                 : choose_shape(n_cells, n_ranks);
  const BlockDecomposition blocks(MPI_COMM_WORLD,
                                  {equal_parts(n_cells[0], shape[0], 4), equal_parts(n_cells[1], shape[1], 4),
                                   equal_parts(n_cells[2], shape[2], 4)},
                                  setup.grid.is_periodic());
  const double dt = options.step > 0 ? options.step : 0.25 * setup.grid.axis[0].width(0) / std::sqrt(2.0);
  FractionalStep step(setup, blocks);
  FlowState state = step.initial_state(), next;
  std::vector<double> seconds;
  int iterations = 0, n_substeps = 0;
  Traffic before;
  AdvanceReport report;
  const int warm_up = 3;  // first steps: start of Adams-Bashforth, first touch of memory
  for (int n = 0; n < warm_up + options.steps; ++n) {
    if (n == warm_up) before = step.traffic();
    MPI_Barrier(MPI_COMM_WORLD);
    const double started = MPI_Wtime();
    report = step.advance(state, dt, next);
    std::swap(state, next);
    const double elapsed = largest(MPI_Wtime() - started);
    if (n < warm_up) continue;
    seconds.push_back(elapsed);
    iterations += report.pressure_iterations;
    n_substeps += report.n_steps;
  }
  const Traffic sent = step.traffic() - before;
  std::sort(seconds.begin(), seconds.end());
  const double cells = std::pow(options.n, 3), energy = kinetic_energy(state, options.n);
  nlohmann::ordered_json row;
  row["n"] = options.n;
  row["ranks"] = n_ranks;
  row["shape"] = {shape[0], shape[1], shape[2]};
  row["scheme"] = report.scheme;
  row["dt"] = dt;
  row["ns_per_cell_step"] = 1e9 * seconds[seconds.size() / 2] / cells;
  row["ns_per_cell_step_best"] = 1e9 * seconds.front() / cells;
  row["bytes_per_cell"] = summed(static_cast<double>(step.n_bytes()) + bytes_of(state) + bytes_of(next)) / cells;
  row["resident_bytes_per_cell"] = (summed(peak_memory()) - memory_before) / cells;
  row["substeps"] = static_cast<double>(n_substeps) / options.steps;
  row["pressure_iterations"] = static_cast<double>(iterations) / options.steps;
  row["divergence"] = report.divergence;
  row["courant"] = report.courant;
  row["time"] = state.time;
  row["kinetic_energy"] = energy;
  row["messages_per_step"] = largest(static_cast<double>(sent.messages)) / options.steps;
  row["bytes_per_step"] = largest(static_cast<double>(sent.bytes)) / options.steps;
  row["reductions_per_step"] = static_cast<double>(sent.reductions) / options.steps;
  if (rank == 0) std::printf("%s\n", row.dump().c_str());
  return 0;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("one measurement of the Taylor-Green vortex, as an object of JSON");
  app.add_option("--n", options.n, "cells in each direction");
  app.add_option("--shape", options.shape, "blocks along x, y, z")->expected(3);
  app.add_option("--steps", options.steps, "steps that are timed");
  app.add_option("--step", options.step, "size of a step");
  app.add_option("--tolerance", options.tolerance, "of the pressure increment, relative");
  app.add_option("--scheme", options.scheme)->check(CLI::IsMember(schemes));
  app.add_option("--pressure", options.pressure)->check(CLI::IsMember(pressure_methods));
  CLI11_PARSE(app, argc, argv);
  return measure(options);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int code = couplet::report::run_program("measure-taylor-green", run, argc, argv);
  if (code != 0) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}
