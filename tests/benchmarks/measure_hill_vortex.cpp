// Steps of Hill's vortex in a sphere, and of the same box without the sphere, on the ranks of one job; prints one
// object of JSON. Driven by hill_vortex.py.

#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/surface_tessellation.hpp"
#include "flow-server/navier_stokes/fractional_step.hpp"
#include "flow-server/navier_stokes/navier_stokes_model.hpp"
#include "proto/report/failure.hpp"
#include "tests/benchmarks/step_clock.hpp"

namespace {

using namespace couplet::flow;

struct Options {
  int n = 64;
  double duration = 0.1;       // [s]
  double courant = 0.25;       // of the largest speed along one direction
  double tolerance = 1e-3;     // of the pressure increment
  std::string fluid = "both";  // sides of the sphere; inside; or none: no sphere
  bool counts_processor = false;
};

// Of a sphere in the middle of a box, all around the origin.
constexpr double radius = 1, side = 3;  // [m]
constexpr double speed = 1;             // V0, on the axis in the middle [m/s]
constexpr double reynolds = 200;        // of speed and diameter
constexpr double largest_side = 0.7;    // of the sphere's triangles, in cells

/// Hill's spherical vortex in the frame of the sphere: u = V0 x z / R^2, v = V0 y z / R^2, w = V0 (1 - (z / R)^2 -
/// 2 (x^2 + y^2) / R^2) [M. J. M. Hill, Phil. Trans. R. Soc. A 185 (1894) 213-245]. The curl of its vorticity is
/// uniform, so that a linear pressure balances viscosity: it solves the Navier-Stokes equations with any viscosity, if
/// the surface of the sphere moves along with it.
Point hill_velocity(const Point& at) {
  const double x = at[0] / radius, y = at[1] / radius, z = at[2] / radius;
  return {speed * x * z, speed * y * z, speed * (1 - z * z - 2 * (x * x + y * y))};
}

bool is_inside(const Point& at) {
  return std::hypot(at[0], at[1], at[2]) < radius;
}

NavierStokesSetup hill_vortex(const Options& options) {
  const StretchedAxis axis(uniform_faces(-0.5 * side, 0.5 * side, options.n), false);
  NavierStokesSetup setup{{{axis, axis, axis}, 3},     1,  0,  {},   {}, {}, {}, {},
                          TimeScheme::adams_bashforth, {}, {}, false};
  setup.viscosity = 2 * radius * speed / reynolds;
  setup.pressure.relative_tolerance = options.tolerance;
  setup.pressure.divergence_tolerance = 0;
  for (std::size_t c = 0; c < 3; ++c)
    setup.initial_velocity[c] =
        SpaceTimeValue::Function([c](const Point& at, double) { return is_inside(at) ? hill_velocity(at)[c] : 0.0; });
  if (options.fluid == "none") return setup;
  const couplet::surface::SurfaceMesh mesh =
      make_ellipsoid({0, 0, 0}, {radius, radius, radius}, largest_side * side / options.n);
  BodySurface sphere;
  sphere.name = "sphere";
  sphere.is_closed = sphere.is_lumen = options.fluid == "inside";
  const SurfaceTessellation tessellation(mesh, sphere.name, {});
  tessellation.interpolate(mesh.node_position, sphere.position);
  for (const Point& at : sphere.position) sphere.velocity.push_back(hill_velocity(at));
  sphere.triangle = tessellation.triangle();
  if (sphere.is_lumen)  // normals point to the fluid
    for (auto& triangle : sphere.triangle) std::swap(triangle[1], triangle[2]);
  setup.bodies = [sphere](double) { return std::vector<BodySurface>{sphere}; };
  return setup;
}

/// Of the velocity inside the sphere, in units of V0: root of the mean square over all faces, largest.
struct Errors {
  double mean = 0, largest = 0;
};

Errors errors_of(const FlowState& state, const StretchedGrid& grid, const Box& mine) {
  double squares = 0, n_faces = 0, largest = 0;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j)
        for (int i = 0; i < mine.size(0); ++i) {
          const Triple cell{mine.begin[0] + i, mine.begin[1] + j, mine.begin[2] + k};
          Point at;
          for (int d = 0; d < 3; ++d)
            at[static_cast<std::size_t>(d)] =
                d == c ? grid.axis[static_cast<std::size_t>(d)].face(cell[static_cast<std::size_t>(d)] + 1)
                       : grid.axis[static_cast<std::size_t>(d)].centre(cell[static_cast<std::size_t>(d)]);
          if (!is_inside(at)) continue;
          const double error =
              state.velocity[static_cast<std::size_t>(c)](i, j, k) - hill_velocity(at)[static_cast<std::size_t>(c)];
          squares += error * error, n_faces += 1, largest = std::max(largest, std::abs(error));
        }
  std::array<double, 2> sums{squares, n_faces};
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  return {std::sqrt(sums[0] / sums[1]) / speed, largest / speed};
}

int measure(const Options& options) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const NavierStokesSetup setup = hill_vortex(options);
  const BlockDecomposition blocks = decompose(setup.grid, std::nullopt, MPI_COMM_WORLD);
  const int n_steps = static_cast<int>(std::ceil(options.duration * speed * options.n / (options.courant * side)));
  const couplet::benchmark::StepClock clock(options.counts_processor);
  FractionalStep step(setup, blocks);
  FlowState state = step.initial_state(), next;
  std::vector<double> seconds;  // of one step of the flow, in each interval
  double whole = 0;
  int iterations = 0, n_flow_steps = 0;
  for (int n = 0; n < n_steps; ++n) {
    AdvanceReport report;
    const double taken = clock.seconds([&] { report = step.advance(state, options.duration / n_steps, next); });
    seconds.push_back(taken / report.n_steps);
    std::swap(state, next);
    iterations += report.pressure_iterations;
    n_flow_steps += report.n_steps;
    whole += taken;
  }
  // The first steps touch memory for the first time and start Adams-Bashforth.
  seconds.erase(seconds.begin(), seconds.begin() + std::min(3, n_steps - 1));
  std::sort(seconds.begin(), seconds.end());
  const double cells = std::pow(options.n, 3);
  nlohmann::ordered_json row;
  row["n"] = options.n;
  row["ranks"] = n_ranks;
  row["fluid"] = options.fluid;
  row["steps"] = n_flow_steps;
  row["ns_per_cell_step"] = 1e9 * seconds[seconds.size() / 2] / cells;
  row["ns_per_cell_step_best"] = 1e9 * seconds.front() / cells;
  row["seconds"] = whole;
  row["pressure_iterations"] = static_cast<double>(iterations) / n_flow_steps;
  if (options.fluid != "none") {
    const Errors errors = errors_of(state, setup.grid, blocks.mine());
    row["error"] = errors.mean;
    row["largest_error"] = errors.largest;
  }
  if (rank == 0) std::printf("%s\n", row.dump().c_str());
  return 0;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("one measurement of Hill's vortex in a sphere, as an object of JSON");
  app.add_option("--n", options.n, "cells in each direction of a box three radii wide")->check(CLI::Range(16, 2048));
  app.add_option("--duration", options.duration, "s, in which the fluid in the middle covers that share of the radius");
  app.add_option("--courant", options.courant, "of the speed in the middle");
  app.add_option("--tolerance", options.tolerance, "of the pressure increment, relative");
  app.add_option("--fluid", options.fluid, "sides of the sphere where fluid is; none: a box without a sphere")
      ->check(CLI::IsMember({"both", "inside", "none"}));
  app.add_flag("--processor-time", options.counts_processor, "of the busiest rank, in place of wall time");
  CLI11_PARSE(app, argc, argv);
  return measure(options);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int code = couplet::report::run_program("measure-hill-vortex", run, argc, argv);
  if (code != 0) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}
