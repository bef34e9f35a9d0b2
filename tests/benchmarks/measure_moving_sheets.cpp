// Steps of a flow through a round tube with three moving sheets on the ranks of one job; prints one object of JSON.
// Driven by moving_sheets.py.

#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/moving_surface.hpp"
#include "flow-server/navier_stokes/flow_domain.hpp"
#include "flow-server/navier_stokes/fractional_step.hpp"
#include "flow-server/navier_stokes/navier_stokes_model.hpp"
#include "flow-server/navier_stokes/predictor.hpp"
#include "flow-server/navier_stokes/projection.hpp"
#include "proto/report/failure.hpp"
#include "tests/benchmarks/step_clock.hpp"

namespace {

using namespace couplet::flow;
using couplet::benchmark::StepClock;
using couplet::surface::NodeArray;

struct Options {
  double size = 1;  // of everything, in cells: 1 is a box of 400 x 130 x 130
  int steps = 10;
  double tolerance = 1e-3;
  std::vector<int> blocks;       // along x, y, z; none: as the flow chooses
  std::string wall = "surface";  // or cells: a staircase
  bool counts_processor = false;
};

// Lengths in cells (which are 1 m wide), speeds in cells a second.
constexpr double step_size = 0.02;                              // [s]
constexpr double speed = 1, mean_speed = 0.15, reynolds = 500;  // of the jet between the sheets; of the tube
constexpr double largest_side = 0.9;                            // of a sheet's triangles
constexpr double cells_of_tube = 0.18;                          // of the box

/// Where everything is.
struct Valve {
  explicit Valve(double size)
      : n_cells{static_cast<int>(std::lround(400 * size)), static_cast<int>(std::lround(130 * size)),
                static_cast<int>(std::lround(130 * size))},
        radius(std::sqrt(cells_of_tube / std::numbers::pi) * n_cells[1]),
        centre(0.5 * n_cells[1] + 0.013),
        root(0.4 * n_cells[0]),
        width(60 * size),
        length(45 * size) {}

  Triple n_cells;
  double radius, centre;  // of the tube
  double root;            // x where the sheets are joined to the wall
  double width, length;   // of a sheet
};

/// A round tube along x with lids beyond both ends of the box, fluid inside.
BodySurface tube_surface(const Valve& valve) {
  const int n_around = static_cast<int>(std::lround(2 * std::numbers::pi * valve.radius));
  const int n_along = valve.n_cells[0] + 8;
  BodySurface tube;
  tube.name = "tube", tube.is_closed = true, tube.is_lumen = true, tube.is_fixed = true;
  for (int l = 0; l <= n_along; ++l)
    for (int a = 0; a < n_around; ++a) {
      const double angle = 2 * std::numbers::pi * a / n_around;
      tube.position.push_back(
          {l - 4.0, valve.centre + valve.radius * std::cos(angle), valve.centre + valve.radius * std::sin(angle)});
    }
  for (const double x : {-4.0, n_along - 4.0}) tube.position.push_back({x, valve.centre, valve.centre});
  tube.velocity.assign(tube.position.size(), Point{});
  const int first_middle = (n_along + 1) * n_around;
  for (int a = 0; a < n_around; ++a) {
    const int next = (a + 1) % n_around, last = n_along * n_around;
    for (int l = 0; l < n_along; ++l) {
      const int here = l * n_around + a, beside = l * n_around + next;
      tube.triangle.push_back({here, here + n_around, beside + n_around});
      tube.triangle.push_back({here, beside + n_around, beside});
    }
    tube.triangle.push_back({first_middle, a, next});
    tube.triangle.push_back({first_middle + 1, last + next, last + a});
  }
  return tube;
}

/// A third of a cone, joined to the wall at its wide end, whose angle to the wall swings.
class Leaflet {
 public:
  Leaflet(const Valve& valve, int number, const StretchedGrid& grid)
      : valve_(valve), middle_((2.0 / 3) * std::numbers::pi * number + 0.1) {
    mesh_ = make_rectangle({0, 0, 0}, {valve.width, 0, 0}, {0, valve.length, 0}, largest_side);
    flat_ = mesh_.node_position;
    BodySetup body;
    body.name = "leaflet " + std::to_string(number);
    body.is_closed = false;
    place(0, mesh_.node_position, velocity_);
    body.mesh = mesh_;
    const double far = 2.0 * valve.n_cells[1];
    body.attached = {{{valve.root - 0.01, -far, -far}, {valve.root + 0.01, far, far}}};
    body.attached_length = 2;
    surface_ = std::make_unique<MovingSurface>(body, grid);
  }

  const BodySurface& at(double time) {
    place(time, mesh_.node_position, velocity_);
    surface_->follow(mesh_.node_position, velocity_);
    return surface_->surface();
  }

 private:
  void place(double time, NodeArray& position, NodeArray& velocity) const {
    const double mean = std::numbers::pi / 7, swing = std::numbers::pi / 20;
    const double rate = 0.6 * speed / (swing * valve_.length);  // the tip's speed stays below that of the flow
    const double angle = mean + swing * std::sin(rate * time), turning = swing * rate * std::cos(rate * time);
    position.resize(flat_.rows(), 3);
    velocity.resize(flat_.rows(), 3);
    for (Eigen::Index n = 0; n < flat_.rows(); ++n) {
      const double along = flat_(n, 1), around = middle_ + (flat_(n, 0) - 0.5 * valve_.width) / valve_.radius;
      const double radius = valve_.radius - 0.2 - along * std::sin(angle);
      const double inwards = along * std::cos(angle) * turning;
      position.row(n) << valve_.root + along * std::cos(angle), valve_.centre + radius * std::cos(around),
          valve_.centre + radius * std::sin(around);
      velocity.row(n) << -along * std::sin(angle) * turning, -inwards * std::cos(around), -inwards * std::sin(around);
    }
  }

  Valve valve_;
  double middle_;  // [rad]
  couplet::surface::SurfaceMesh mesh_;
  NodeArray flat_, velocity_;
  std::unique_ptr<MovingSurface> surface_;
};

FacePatch opening(double pressure) {
  FacePatch patch;
  patch.name = pressure > 0 ? "inlet" : "outlet";
  patch.condition = PressureOpening{SpaceTimeValue(pressure)};
  return patch;
}

/// The least of all steps, of each part by itself [s].
struct Seconds {
  double step = 0, surfaces = 0;
  double crossings = 0, cut_cells = 0, pieces = 0, trees = 0, layer = 0, whole = 0;
  double solver_update = 0, pressure_solve = 0, predictor = 0, forcing = 0;
  double geometry() const { return crossings + cut_cells + pieces + trees + layer + whole; }
  double rest() const { return step - surfaces - geometry() - solver_update - pressure_solve - predictor - forcing; }
};

/// The geometry of one position part by part, as BodyGeometry has it.
struct GeometryParts {
  GeometryParts(const FlowBlock& block, const BodyFlowSettings& settings)
      : crossings(*block.grid, block.decomposition->mine(), 5),
        cut(*block.grid, crossings),
        pieces(block, cut),
        layer(block, cut, settings.wall) {}

  void place(std::vector<BodySurface> moved, const FlowBlock& block, const StepClock& clock, Seconds& seconds) {
    surfaces = std::move(moved);
    seconds.crossings += clock.seconds([&] { crossings.update(surfaces); });
    seconds.cut_cells += clock.seconds([&] { cut.update(surfaces); });
    seconds.pieces += clock.seconds([&] { pieces.update(surfaces); });
    seconds.trees += clock.seconds([&] {
      for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const std::array<SurfaceInTree, 1> in_tree{
            SurfaceInTree{&surfaces[s], {}, static_cast<int>(surfaces[s].triangle.size())}};
        if (trees.size() <= s) {
          trees.emplace_back(in_tree);
        } else {
          trees[s].refit(in_tree);
        }
      }
    });
    seconds.layer += clock.seconds([&] { layer.update(surfaces, trees); });
    seconds.whole += clock.seconds([&] { n_whole_cells = cut.whole(block.cells).n_cells(); });
  }

  std::vector<BodySurface> surfaces;
  EdgeCrossings crossings;
  CutCells cut;
  PressurePieces pieces;
  WallLayer layer;
  std::vector<SurfaceTree> trees;
  std::int64_t n_whole_cells = 0;
};

/// The first half of a step once more, part by part, from the state at which that step started.
class StepParts {
 public:
  StepParts(const NavierStokesSetup& setup, const BlockDecomposition& blocks)
      : setup_(setup),
        solid_(find_fixed_solid(setup, blocks)),
        border_(setup.grid, blocks, setup.border, fluid_of(setup, solid_), setup.balances_inflow),
        block_(make_flow_block(setup, blocks, border_, solid_)),
        ghosts_(block_, border_),
        bodies_(block_, setup.body_settings),
        predictor_(setup, block_, border_, ghosts_, &bodies_),
        problem_(make_pressure_problem(setup, block_, border_)),
        solver_(make_pressure_solver(problem_, setup.pressure.method)),
        source_(block_.new_field()),
        phi_(block_.new_field()) {
    to_.pressure = block_.new_field();
    to_.velocity = block_.new_vector_field();
    for (auto& geometry : geometry_) geometry = std::make_unique<GeometryParts>(block_, setup.body_settings);
  }

  void repeat(const FlowState& from, double dt, const StepClock& clock, Seconds& seconds) {
    std::vector<BodySurface> moved;
    seconds.surfaces += clock.seconds([&] { moved = setup_.bodies(from.time + dt); });
    std::swap(geometry_[0], geometry_[1]);  // a step finds the geometry of two steps before
    geometry_[0]->place(moved, block_, clock, seconds);
    if (to_.bodies) {
      to_.bodies->place(std::move(moved));
    } else {
      to_.bodies = bodies_.make_geometry(std::move(moved));
    }
    BodyGeometry& now = *to_.bodies;
    seconds.predictor += clock.seconds([&] { predictor_.predict(from, dt, setup_.scheme, to_); });
    seconds.solver_update += clock.seconds([&] {
      std::vector<Box> changed;
      if (bodies_.write_problem(now, problem_, changed)) solver_->update(changed);
    });
    const double step_over_density = dt / setup_.density;
    seconds.forcing += clock.seconds([&] {
      bodies_.forcing().force(*from.bodies, now, from.pressure, std::bind_front(&FlowGhosts::fill_deep, &ghosts_),
                              to_.velocity);
      bodies_.carry_pressure(*from.bodies, from.pressure, now, to_.pressure);
      bodies_.forcing().take_slopes_of(now, step_over_density, to_.pressure, to_.velocity);
    });
    ghosts_.while_filling(to_.velocity, false, [&](const Box& box) {
      take_divergence(block_, box, 1 / step_over_density, to_.velocity, source_);
    });
    seconds.forcing += clock.seconds([&] {
      bodies_.take_divergence(now, 1 / step_over_density, to_.velocity, bodies_.forcing().piece_velocity(), source_,
                              piece_source_);
    });
    piece_phi_.assign(piece_source_.size(), 0.0);
    std::fill(phi_.data(), phi_.data() + phi_.n_values(), 0.0);
    seconds.pressure_solve += clock.seconds([&] {
      solver_->solve(source_, phi_, {setup_.pressure.relative_tolerance, 0, setup_.pressure.largest_iterations},
                     piece_source_, piece_phi_);
    });
  }

  /// Of this rank: cells that hold fluid; those of them that a surface cuts.
  std::int64_t n_active() const { return geometry_[0]->n_whole_cells + n_cut(true); }
  std::int64_t n_cut(bool is_fluid) const {
    const Box mine = box_of(block_.sizes);
    return std::count_if(geometry_[0]->cut.cells().begin(), geometry_[0]->cut.cells().end(), [&](const CutCell& cut) {
      return mine.contains(cut.cell) && (!is_fluid || cut.main_part >= 0);
    });
  }

 private:
  const NavierStokesSetup& setup_;
  FixedSolid solid_;
  FlowBorder border_;
  FlowBlock block_;
  FlowGhosts ghosts_;
  ImmersedBodies bodies_;
  Predictor predictor_;
  PressureProblem problem_;
  std::unique_ptr<PressureSolver> solver_;
  Field<double> source_, phi_;
  std::vector<double> piece_source_, piece_phi_;
  FlowState to_;
  std::array<std::unique_ptr<GeometryParts>, 2> geometry_;
};

double summed(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

int measure(const Options& options) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const Valve valve(options.size);
  std::array<StretchedAxis, 3> axis{StretchedAxis(uniform_faces(0, valve.n_cells[0], valve.n_cells[0]), false),
                                    StretchedAxis(uniform_faces(0, valve.n_cells[1], valve.n_cells[1]), false),
                                    StretchedAxis(uniform_faces(0, valve.n_cells[2], valve.n_cells[2]), false)};
  NavierStokesSetup setup{{axis, 3}, 1, 0, {}, {}, {}, {}, {}, TimeScheme::adams_bashforth, {}, {}, false};
  setup.viscosity = 2 * valve.radius * speed / reynolds;
  setup.pressure.method = PressureMethod::multigrid;
  setup.pressure.relative_tolerance = options.tolerance;
  setup.pressure.divergence_tolerance = 0;
  setup.border[0][0] = {opening(speed * speed)};
  setup.border[0][1] = {opening(0)};
  const bool has_surface = options.wall == "surface";
  const auto is_inside = [valve](const Point& at) {
    return std::hypot(at[1] - valve.centre, at[2] - valve.centre) < valve.radius;
  };
  if (!has_surface) setup.is_fluid = is_inside;
  setup.initial_velocity[0] =
      SpaceTimeValue::Function([is_inside](const Point& at, double) { return is_inside(at) ? mean_speed : 0.0; });
  std::vector<std::shared_ptr<Leaflet>> leaflets;
  for (int n = 0; n < 3; ++n) leaflets.push_back(std::make_shared<Leaflet>(valve, n, setup.grid));
  setup.bodies = [leaflets, tube = has_surface ? tube_surface(valve) : BodySurface{}, has_surface](double time) {
    std::vector<BodySurface> surfaces;
    if (has_surface) surfaces.push_back(tube);
    for (const auto& leaflet : leaflets) surfaces.push_back(leaflet->at(time));
    return surfaces;
  };
  std::optional<Triple> shape;
  if (!options.blocks.empty()) shape = {options.blocks[0], options.blocks[1], options.blocks[2]};
  const BlockDecomposition blocks = decompose(setup.grid, shape, MPI_COMM_WORLD);

  FractionalStep step(setup, blocks);
  StepParts parts(setup, blocks);
  FlowState state = step.initial_state(), next;
  const StepClock clock(options.counts_processor);
  Seconds seconds;
  int iterations = 0;
  const int warm_up = 3;  // first steps: start of Adams-Bashforth, first touch of memory
  for (int n = 0; n < warm_up + options.steps; ++n) {
    Seconds one;
    AdvanceReport report;
    one.step += clock.seconds([&] { report = step.advance(state, step_size, next); });
    if (n > 0) parts.repeat(state, step_size, clock, one);
    std::swap(state, next);
    if (report.n_steps != 1)
      throw couplet::report::NumericsError("step " + std::to_string(n), "was cut in " + std::to_string(report.n_steps),
                                           "take a smaller one");
    if (n < warm_up) continue;
    for (double Seconds::*part :
         {&Seconds::step, &Seconds::surfaces, &Seconds::crossings, &Seconds::cut_cells, &Seconds::pieces,
          &Seconds::trees, &Seconds::layer, &Seconds::whole, &Seconds::solver_update, &Seconds::pressure_solve,
          &Seconds::predictor, &Seconds::forcing})
      seconds.*part = n == warm_up ? one.*part : std::min(seconds.*part, one.*part);
    iterations += report.pressure_iterations;
  }
  const double cells = summed(static_cast<double>(parts.n_active())),
               cut = summed(static_cast<double>(parts.n_cut(false)));
  const auto milliseconds = [](double time) { return 1e3 * time; };
  nlohmann::ordered_json row;
  row["box"] = {valve.n_cells[0], valve.n_cells[1], valve.n_cells[2]};
  row["wall"] = options.wall;
  row["ranks"] = n_ranks;
  row["cells_active"] = cells;
  row["cells_cut"] = cut;
  row["bytes_per_cell"] = summed(static_cast<double>(step.n_bytes())) / cells;
  row["ns_per_cell_step_iteration"] = 1e9 * seconds.step / cells;
  row["geometry_share"] = seconds.geometry() / seconds.step;
  row["geometry_over_pressure_solve"] = seconds.geometry() / seconds.pressure_solve;
  row["pressure_iterations"] = static_cast<double>(iterations) / options.steps;
  row["ms"] = {{"step", milliseconds(seconds.step)},
               {"surfaces", milliseconds(seconds.surfaces)},
               {"geometry", milliseconds(seconds.geometry())},
               {"solver_update", milliseconds(seconds.solver_update)},
               {"pressure_solve", milliseconds(seconds.pressure_solve)},
               {"predictor", milliseconds(seconds.predictor)},
               {"forcing", milliseconds(seconds.forcing)},
               {"rest", milliseconds(seconds.rest())}};
  row["ns_per_cut_cell"] = nlohmann::ordered_json::object();
  const std::vector<std::pair<const char*, double>> of_geometry{
      {"crossings", seconds.crossings}, {"cut_cells", seconds.cut_cells}, {"pieces", seconds.pieces},
      {"trees", seconds.trees},         {"layer", seconds.layer},         {"whole", seconds.whole}};
  for (const auto& [name, time] : of_geometry) row["ns_per_cut_cell"][name] = 1e9 * time / cut;
  if (rank == 0) std::printf("%s\n", row.dump().c_str());
  return 0;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("one measurement of a tube with three moving sheets, as an object of JSON");
  app.add_option("--size", options.size, "1: a box of 400 x 130 x 130 cells")->check(CLI::Range(0.2, 4.0));
  app.add_option("--steps", options.steps, "steps that are timed")->check(CLI::PositiveNumber);
  app.add_option("--tolerance", options.tolerance, "of the pressure increment, relative");
  app.add_option("--blocks", options.blocks, "of the grid along x, y and z, one a rank")->expected(3);
  app.add_option("--wall", options.wall, "of the tube: a surface that cuts cells, or whole cells")
      ->check(CLI::IsMember({"surface", "cells"}));
  app.add_flag("--processor-time", options.counts_processor, "of the busiest rank, in place of wall time");
  CLI11_PARSE(app, argc, argv);
  return measure(options);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int code = couplet::report::run_program("measure-moving-sheets", run, argc, argv);
  if (code != 0) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}
