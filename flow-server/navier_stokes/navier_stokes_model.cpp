#include "flow-server/navier_stokes/navier_stokes_model.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "flow-server/immersed/triangle_geometry.hpp"
#include "flow-server/navier_stokes/body_placement.hpp"
#include "flow-server/poisson/multigrid.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

/// Parts whose borders stand at multiples of 8, 4 or 2, so that multigrid merges cells of one rank: at the largest of
/// these that makes no part more than a sixteenth larger than equal sharing would.
Partition balanced_parts(int n_cells, int n_parts) {
  const int equal_share = (n_cells + n_parts - 1) / n_parts;
  for (const int alignment : {8, 4, 2}) {
    const Partition partition = equal_parts(n_cells, n_parts, alignment);
    int largest = 0;
    for (int p = 0; p < n_parts; ++p) largest = std::max(largest, partition.start[p + 1] - partition.start[p]);
    if (16 * largest <= 17 * equal_share) return partition;
  }
  return equal_parts(n_cells, n_parts, 1);
}

/// Adds the time from its making to its end.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void sum_over_ranks(std::vector<double>& values, MPI_Comm communicator) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, communicator);
}

std::size_t n_bytes(const FlowState& state) {
  std::size_t n = state.pressure.n_bytes();
  for (int d = 0; d < 3; ++d) n += state.velocity[d].n_bytes() + state.rate[d].n_bytes();
  return n;
}

}  // namespace

BlockDecomposition decompose(const StretchedGrid& grid, const std::optional<Triple>& shape, MPI_Comm ranks) {
  int n_ranks = 1;
  MPI_Comm_size(ranks, &n_ranks);
  const Triple n_cells = grid.n_cells();
  const Triple blocks = shape.value_or(choose_shape(n_cells, n_ranks));
  if (blocks[0] * blocks[1] * blocks[2] != n_ranks) {
    throw report::SceneError("flow.navier_stokes.decomposition",
                             std::to_string(blocks[0]) + " x " + std::to_string(blocks[1]) + " x " +
                                 std::to_string(blocks[2]) + " blocks are not one for each of the " +
                                 std::to_string(n_ranks) + " ranks",
                             "start the flow with as many ranks as blocks, or leave decomposition out");
  }
  std::array<Partition, 3> partitions = suitable_partitions(grid, blocks);
  for (int d = 0; d < 3; ++d) {
    // What the multigrid would like is worth no more than a sixteenth of waiting for the largest block.
    int largest = 0;
    for (int p = 0; p < blocks[d]; ++p)
      largest = std::max(largest, partitions[d].start[p + 1] - partitions[d].start[p]);
    const int equal_share = (n_cells[d] + blocks[d] - 1) / blocks[d];
    if (16 * largest > 17 * equal_share) partitions[d] = balanced_parts(n_cells[d], blocks[d]);
  }
  return {ranks, std::move(partitions), grid.is_periodic()};
}

namespace {

/// Collective. Refuses a box of fluid that this machine could not hold: it would compute for long before it fails. Of a
/// box with solid parts only what holds fluid takes memory.
const BlockDecomposition& that_fits(const BlockDecomposition& decomposition, bool has_solid) {
  constexpr double least_bytes_per_cell = 140;
  MPI_Comm here;
  MPI_Comm_split_type(decomposition.communicator(), MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  double wanted = has_solid ? 0 : least_bytes_per_cell * static_cast<double>(decomposition.mine().n_cells());
  MPI_Allreduce(MPI_IN_PLACE, &wanted, 1, MPI_DOUBLE, MPI_SUM, here);
  MPI_Comm_free(&here);
  const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  double excess = wanted / there;
  MPI_Allreduce(MPI_IN_PLACE, &excess, 1, MPI_DOUBLE, MPI_MAX, decomposition.communicator());
  if (excess > 1)
    throw report::SceneError("flow.navier_stokes.grid",
                             report::text(static_cast<double>(decomposition.all().n_cells())) +
                                 " cells need at least " + report::text(excess) + " times the memory of this machine",
                             "use fewer cells, or more hosts");
  return decomposition;
}

}  // namespace

NavierStokesModel::NavierStokesModel(NavierStokesOptions options, MPI_Comm ranks)
    : options_(std::move(options)),
      surfaces_(make_surfaces()),
      decomposition_(decompose(options_.setup.grid, options_.shape, ranks)),
      notes_(note_placement()),
      step_(options_.setup, that_fits(decomposition_, options_.setup.is_fluid || options_.setup.bodies)),
      accepted_(step_.initial_state()),
      force_(surface::NodeArray::Zero(0, 3)) {
  for (const BalanceBox& box : options_.observed.balances) cells_of(options_.setup.grid, box);  // throws at once
  interface_.node_position = surface::NodeArray::Zero(0, 3);
  if (options_.coupled) interface_ = options_.bodies[static_cast<std::size_t>(*options_.coupled)].mesh;
  if (!options_.initial_file.empty()) read_state(options_.initial_file, false);
  measure_loads(accepted_);
}

FlowPart NavierStokesModel::part() const {
  return {options_.setup.grid, decomposition_, step_.active(), accepted_};
}

std::optional<BodySurfaces> NavierStokesModel::make_surfaces() {
  if (options_.bodies.empty()) return std::nullopt;
  if (options_.coupled) options_.bodies[static_cast<std::size_t>(*options_.coupled)].is_moved_from_outside = true;
  options_.setup.bodies = [this](double time) { return surfaces_->at(time); };
  return std::optional<BodySurfaces>(std::in_place, options_.bodies, options_.setup.grid);
}

std::vector<std::string> NavierStokesModel::note_placement() {
  if (!surfaces_) return {};
  std::vector<std::string> notes = surfaces_->notes();
  // The motion of a coupled body comes later.
  const std::vector<std::string> found = check_placement(*surfaces_, options_.setup.grid, decomposition_);
  notes.insert(notes.end(), found.begin(), found.end());
  return notes;
}

std::vector<std::string> NavierStokesModel::needs() const {
  if (!options_.coupled) return {};
  return {"displacement", "velocity"};
}

void NavierStokesModel::solve_step(double duration, const surface::FieldSet& motion) {
  const Stopwatch watch(solve_seconds_);
  if (options_.coupled)
    surfaces_->set_motion(*options_.coupled,
                          {accepted_.time + duration, surface::find_field(motion, "displacement").values,
                           surface::find_field(motion, "velocity").values});
  report_ = step_.advance(accepted_, duration, trial_);
  n_substeps_ += report_.n_steps;
  if (options_.coupled) measure_loads(trial_);
}

void NavierStokesModel::measure_loads(const FlowState& state) {
  loads_ = step_.body_loads(state);
  if (!options_.coupled) return;
  const auto body = static_cast<std::size_t>(*options_.coupled);
  force_ = surfaces_->nodal_force(*options_.coupled, loads_[body].corner_force);
}

std::vector<FlowQuantity> NavierStokesModel::accept_step() {
  std::swap(accepted_, trial_);
  const Stopwatch watch(measure_seconds_);
  if (options_.coupled) {
    surfaces_->accept_motion();
  } else {
    measure_loads(accepted_);
  }
  std::vector<FlowQuantity> quantities{
      {"flow.substeps", static_cast<double>(report_.n_steps), "1"},
      {"flow.courant", report_.courant, "1"},
      {"flow.largest_speed", report_.largest_speed, "m/s"},
      {"flow.divergence", report_.divergence, "1/s"},
      {"flow.pressure_iterations", static_cast<double>(report_.pressure_iterations), "1"},
      {"flow.pressure_residual", report_.pressure_residual, "1"},
  };
  add_body_quantities(quantities);
  add_measurements(quantities);
  return quantities;
}

/// Forces; their power on the motion of bodies that move; moments.
void NavierStokesModel::add_body_quantities(std::vector<FlowQuantity>& quantities) const {
  const int n_dimensions = options_.setup.grid.n_dimensions;
  for (std::size_t b = 0; b < loads_.size(); ++b) {
    const BodySetup& body = options_.bodies[b];
    const BodySurface& surface = accepted_.bodies->surfaces()[b];
    const std::string name = "body." + body.name + ".";
    for (int d = 0; d < n_dimensions; ++d) {
      const auto at = static_cast<std::size_t>(d);
      const std::string direction(1, "xyz"[d]);
      const double pressure = loads_[b].pressure_force[at], viscous = loads_[b].viscous_force[at];
      quantities.push_back({name + "force_" + direction, pressure + viscous, "N"});
      quantities.push_back({name + "viscous_force_" + direction, viscous, "N"});
    }
    if (!body.motion.is_fixed() || options_.coupled == static_cast<int>(b)) {
      double power = 0;  // sum of F_c . u_c
      for (std::size_t c = 0; c < surface.velocity.size(); ++c)
        power += dot(loads_[b].corner_force[c], surface.velocity[c]);
      quantities.push_back({name + "power", power, "W"});
    }
    for (const FlowObservation::Moment& moment : options_.observed.moments) {
      if (moment.body != b) continue;
      Eigen::Vector3d about = Eigen::Vector3d::Map(moment.about.data());
      if (moment.is_carried) {
        const RigidPose pose = body.motion.pose(accepted_.time);
        about = pose.rotation * about + pose.shift;
      }
      const Point value = moment_about({about[0], about[1], about[2]}, surface, loads_[b].corner_force);
      for (int d = n_dimensions == 2 ? 2 : 0; d < 3; ++d)
        quantities.push_back({name + "moment_" + std::string(1, "xyz"[d]), value[static_cast<std::size_t>(d)], "N m"});
    }
  }
}

void NavierStokesModel::add_measurements(std::vector<FlowQuantity>& quantities) const {
  const FlowObservation& observed = options_.observed;
  const FlowPart mine = part();
  std::vector<FlowQuantity> summed;  // of this rank at first
  if (observed.has_integrals) {
    const IntegralQuantities integrals = integrate(mine, options_.setup.density, options_.setup.viscosity);
    summed.push_back({"flow.kinetic_energy", integrals.kinetic_energy, "J"});
    summed.push_back({"flow.dissipation", integrals.dissipation, "W"});
    summed.push_back({"flow.enstrophy", integrals.enstrophy, "m^3/s^2"});
  }
  for (const PlaneCut& plane : observed.planes) {
    const PlaneRates rates = integrate(mine, plane, options_.setup.density);
    summed.push_back({plane.name + ".flow_rate", rates.flow_rate, "m^3/s"});
    summed.push_back({plane.name + ".momentum_flux", rates.momentum_flux, "N"});
  }
  for (const PointProbe& probe : observed.probes) {
    const PointValue value = measure(mine, probe);
    for (int d = 0; d < options_.setup.grid.n_dimensions; ++d)
      summed.push_back({probe.name + ".velocity_" + std::string(1, "xyz"[d]), value.velocity[d], "m/s"});
    summed.push_back({probe.name + ".pressure", value.pressure, "Pa"});
  }
  for (const BalanceBox& box : observed.balances) {
    const NavierStokesSetup& setup = options_.setup;
    const Box cells = cells_of(setup.grid, box);
    const auto momentum_in = [&](const FlowState& state) {
      return measure_momentum({setup.grid, decomposition_, step_.active(), state}, cells, setup.density,
                              setup.viscosity, setup.body_force);
    };
    // The state before is the one that the accepted one has changed places with. Linear in what ranks measure.
    const Point force = force_on_bodies(momentum_in(trial_), momentum_in(accepted_));
    for (int d = 0; d < setup.grid.n_dimensions; ++d)
      summed.push_back({box.name + ".force_balance_" + std::string(1, "xyz"[d]), force[d], "N"});
  }
  if (!summed.empty()) {
    std::vector<double> values;
    for (const FlowQuantity& quantity : summed) values.push_back(quantity.value);
    sum_over_ranks(values, decomposition_.communicator());
    for (std::size_t i = 0; i < summed.size(); ++i) summed[i].value = values[i];
    quantities.insert(quantities.end(), summed.begin(), summed.end());
  }
  if (!observed.exact) return;

  const ErrorSums errors = compare(mine, *observed.exact);
  std::vector<double> sums{errors.velocity_square, errors.pressure, errors.pressure_square, errors.volume};
  sum_over_ranks(sums, decomposition_.communicator());
  double largest = errors.largest_velocity;
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, decomposition_.communicator());
  const double mean = sums[1] / sums[3];  // a pressure is known but for a constant
  quantities.push_back({"flow.velocity_error_l2", std::sqrt(sums[0] / sums[3]), "m/s"});
  quantities.push_back({"flow.velocity_error_max", largest, "m/s"});
  quantities.push_back({"flow.pressure_error_l2", std::sqrt(std::max(0.0, sums[2] / sums[3] - mean * mean)), "Pa"});
}

void NavierStokesModel::write_checkpoint(const std::filesystem::path& path) const {
  const Stopwatch watch(checkpoint_seconds_);
  const std::optional<NodalMotion> motion = options_.coupled ? surfaces_->start(*options_.coupled) : std::nullopt;
  write_navier_stokes_checkpoint(path, accepted_, options_.setup.grid, decomposition_, motion);
}

void NavierStokesModel::resume(const std::filesystem::path& path) {
  read_state(path, true);
  measure_loads(accepted_);
}

/// Of this run, to go on; or the flow of another run as that at t = 0, where bodies start as this run says.
void NavierStokesModel::read_state(const std::filesystem::path& path, bool is_same_run) {
  const StoredBodies stored = read_navier_stokes_checkpoint(path, options_.setup.grid, decomposition_, accepted_);
  const double courant_rate = accepted_.courant_rate, largest_speed = accepted_.largest_speed;
  if (!is_same_run) {
    accepted_.time = accepted_.pressure_time = 0;
    accepted_.last_step = std::numeric_limits<double>::quiet_NaN();
    accepted_.rate_kind = RateKind::none;  // what was before belongs to another run
  }
  if (is_same_run) require_same_bodies(stored, path);
  if (is_same_run && stored.motion && options_.coupled) surfaces_->set_start(*options_.coupled, *stored.motion);
  step_.place_bodies(accepted_);
  if (accepted_.bodies) {
    int n_missing = restore_bodies(stored, options_.setup.grid, decomposition_, accepted_);
    MPI_Allreduce(MPI_IN_PLACE, &n_missing, 1, MPI_INT, MPI_SUM, decomposition_.communicator());
    if (is_same_run && n_missing > 0)
      throw report::FileError(path.string(), "its bodies do not stand where those of the scene do",
                              "resume with the scene of the run that wrote the checkpoint");
  }
  step_.fill_ghosts(accepted_);
  if (!is_same_run) return;
  // Measured again they would differ in the last bit, and with them the tolerance of the next pressure.
  accepted_.courant_rate = courant_rate;
  accepted_.largest_speed = largest_speed;
}

void NavierStokesModel::require_same_bodies(const StoredBodies& stored, const std::filesystem::path& path) const {
  std::vector<std::string> names;
  for (const BodySetup& body : options_.bodies) names.push_back(body.name);
  if (stored.names == names) return;
  throw report::FileError(path.string(),
                          "its flow has " + std::to_string(stored.names.size()) + " bodies, that of the scene " +
                              std::to_string(names.size()) +
                              (stored.names.size() == names.size() ? " of other names" : ""),
                          "resume with the scene of the run that wrote the checkpoint");
}

void NavierStokesModel::start_results(const std::filesystem::path& results_folder) {
  const Stopwatch watch(results_seconds_);
  stored_surfaces_.clear();
  for (std::size_t b = 0; b < options_.bodies.size(); ++b)
    stored_surfaces_.push_back(stored_surface(surfaces_->shown(static_cast<int>(b))));
  results_.emplace(results_folder, options_.setup.grid, decomposition_, options_.observed.regions, accepted_.time,
                   stored_surfaces_);
}

void NavierStokesModel::append_results() {
  const Stopwatch watch(results_seconds_);
  if (!accepted_.bodies) return results_->append(part());
  std::vector<std::vector<Point>> force;
  for (std::size_t b = 0; b < loads_.size(); ++b)
    force.push_back(surfaces_->shown_force(static_cast<int>(b), loads_[b].corner_force));
  results_->append(part(), measure_surfaces(part(), stored_surfaces_, loads_, force));
}

std::vector<FlowQuantity> NavierStokesModel::costs() const {
  std::vector<double> sums{
      static_cast<double>(step_.active().n_cells()),
      static_cast<double>(n_bytes(accepted_) + n_bytes(trial_) + step_.n_bytes()),
      static_cast<double>(step_.traffic().messages),
      static_cast<double>(step_.traffic().bytes),
  };
  sum_over_ranks(sums, decomposition_.communicator());
  const double n_cells = static_cast<double>(decomposition_.all().n_cells());
  const double n_steps = static_cast<double>(std::max<std::int64_t>(1, n_substeps_));
  return {
      {"ranks", static_cast<double>(decomposition_.n_ranks()), "1"},
      {"cells", n_cells, "1"},
      {"cells_active", sums[0], "1"},
      {"substeps", static_cast<double>(n_substeps_), "1"},
      {"ns_per_cell_step", 1e9 * solve_seconds_ / (sums[0] * n_steps), "ns"},
      {"bytes_per_cell", sums[1] / sums[0], "1"},
      {"messages_per_step", sums[2] / n_steps, "1"},
      {"message_bytes_per_step", sums[3] / n_steps, "1"},
      {"seconds_solve", solve_seconds_, "s"},
      {"seconds_measurements", measure_seconds_, "s"},
      {"seconds_results", results_seconds_, "s"},
      {"seconds_checkpoints", checkpoint_seconds_, "s"},
  };
}

}  // namespace couplet::flow
