// Errors of an exact flow in three dimensions around a sphere on one grid, as one object of JSON. Driven by
// validate.py.

#include <mpi.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

#include "proto/report/failure.hpp"
#include "tests/verification/sphere_in_exact_flow.hpp"

namespace {

using namespace couplet::flow;

int run(int argc, char** argv) {
  SphereInExactFlow sphere;
  bool is_absent = false;
  CLI::App app("errors of the flow of Ethier and Steinman around a sphere, as an object of JSON");
  app.add_option("--cells", sphere.n, "along each side of the box, four radii long")->check(CLI::Range(16, 512));
  app.add_option("--drift", sphere.drift, "speed of the sphere along x, m/s");
  app.add_flag("--without", is_absent, "the same flow without the sphere");
  CLI11_PARSE(app, argc, argv);
  sphere.has_sphere = !is_absent;
  const std::clock_t start = std::clock();
  const SphereErrors errors = errors_around_sphere(sphere);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  nlohmann::ordered_json row;
  row["velocity_largest"] = errors.velocity.largest;
  row["velocity_rms"] = errors.velocity.rms;
  row["pressure_largest"] = errors.pressure.largest;
  row["pressure_beyond_a_cell"] = errors.pressure_beyond_a_cell;
  row["steps"] = errors.n_steps;
  row["core_seconds"] = summed(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  if (rank == 0) std::printf("%s\n", row.dump().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int code = couplet::report::run_program("measure-ethier-steinman-sphere", run, argc, argv);
  if (code != 0) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}
