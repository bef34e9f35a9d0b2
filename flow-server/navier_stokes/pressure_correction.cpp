#include "flow-server/navier_stokes/pressure_correction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "flow-server/navier_stokes/flow_domain.hpp"
#include "flow-server/navier_stokes/flow_failure.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

/// Initial fields are free of divergence almost to round-off.
constexpr double initial_tolerance = 1e-10;
constexpr int initial_iterations = 200;

/// Largest |div u| times the smallest width over the largest speed that a projection may leave.
constexpr double largest_divergence = 0.05;
/// A flow with smaller Courant numbers is at rest: what moves is round-off of forces that balance.
constexpr double courant_at_rest = 1e-8;

/// The largest Courant number of the schemes, 1.2, is that of a wall that moves by one cell.
constexpr double courant_number_of_one_cell = 1.2;

using report::text;

double smallest_width_of(const StretchedGrid& grid) {
  double width = std::numeric_limits<double>::infinity();
  for (int d = 0; d < grid.n_dimensions; ++d) width = std::min(width, grid.axis[d].smallest_width());
  return width;
}

}  // namespace

PressureCorrection::PressureCorrection(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border,
                                       FlowGhosts& ghosts, ImmersedBodies* bodies)
    : setup_(setup),
      block_(block),
      border_(border),
      ghosts_(ghosts),
      problem_(make_pressure_problem(setup, block, border)),
      solver_(make_pressure_solver(problem_, setup.pressure.method)),
      source_(block.new_field()),
      phi_(block.new_field()),
      bodies_(bodies),
      smallest_width_(smallest_width_of(setup.grid)) {}

void PressureCorrection::place_bodies(double time, FlowState& state) {
  if (!bodies_) return;
  if (state.bodies && state.bodies.use_count() == 1) {
    state.bodies->place(setup_.bodies(time));
  } else {
    state.bodies = bodies_->make_geometry(setup_.bodies(time));
  }
}

/// The walls at the end of the step in a predicted velocity, and the pressure problem that goes with them.
void PressureCorrection::force_walls(const FlowState& from, double step_over_density, FlowState& to) {
  BodyGeometry& now = *to.bodies;
  std::vector<Box> changed;
  if (bodies_->write_problem(now, problem_, changed)) solver_->update(changed);
  whole_cells_ = now.cut().whole(block_.cells);
  WallForcing& forcing = bodies_->forcing();
  forcing.force(*from.bodies, now, from.pressure, std::bind_front(&FlowGhosts::fill_deep, &ghosts_), to.velocity);
  bodies_->carry_pressure(*from.bodies, from.pressure, now, to.pressure);
  forcing.take_slopes_of(now, step_over_density, to.pressure, to.velocity);
}

PressureCorrection::Result PressureCorrection::correct_step(const FlowState& from, double dt, FlowState& to) {
  if (bodies_) force_walls(from, dt / setup_.density, to);
  take_divergence_of(to.velocity, setup_.density / dt, to.bodies.get());
  const double speed_at_rest = courant_at_rest * smallest_width_ / dt;
  const double speed = std::max(from.largest_speed, speed_at_rest);
  const double enough = setup_.pressure.divergence_tolerance * speed / smallest_width_ * setup_.density / dt;
  Result result;
  try {
    result.solved = solve({setup_.pressure.relative_tolerance, enough, setup_.pressure.largest_iterations});
  } catch (const report::NumericsError&) {
    require_finite(block_, to.velocity, from.time + dt);  // a better sentence, where that is the reason
    throw;
  }
  // With implicit diffusion p += phi - mu/2 div u*: u* has felt the gradient of phi less than u has [D. L. Brown,
  // R. Cortez, M. L. Minion, J. Comput. Phys. 168 (2001) 464-499, eq. 72].
  const double viscous_factor =
      to.rate_kind == RateKind::mean_acceleration ? 0.5 * setup_.kinematic_viscosity() * dt : 0;
  result.measure =
      reduce(correct_velocity(from, dt / setup_.density, viscous_factor, to), block_.decomposition->communicator());
  n_reductions_ += 2;
  const FlowMeasure& measure = result.measure;
  to.time = from.time + dt;
  to.pressure_time = from.time + 0.5 * dt;
  to.last_step = dt;
  to.courant_rate = measure.courant_rate;
  to.largest_speed = measure.speed;
  ghosts_.fill(to);

  if (!std::isfinite(measure.divergence_sum)) require_finite(block_, to.velocity, to.time);
  if (measure.leaving > 0)
    refuse_leaving_body(*block_.grid, to.bodies->surfaces()[static_cast<std::size_t>(measure.leaving) - 1], to.time);
  if (measure.divergence * smallest_width_ > largest_divergence * std::max(measure.speed, speed_at_rest))
    throw report::NumericsError("pressure at t = " + text(to.time) + " s",
                                "leaves a divergence of " + text(measure.divergence) + " 1/s in a flow of " +
                                    text(measure.speed) + " m/s on cells of " + text(smallest_width_) + " m",
                                "allow more iterations, a smaller tolerance or a smaller step");
  return result;
}

/// u -= dt / rho grad phi, p += phi, everywhere.
FlowMeasure PressureCorrection::correct_velocity(const FlowState& from, double step_over_density, double viscous_factor,
                                                 FlowState& to) {
  if (!bodies_)
    return correct(block_, block_.cells, step_over_density, phi_, viscous_factor, source_, from.pressure, to.pressure,
                   to.velocity);
  // Cells whose place belongs to another part than before start from the pressure of that part.
  BodyGeometry& now = *to.bodies;
  const Box mine = box_of(block_.sizes);
  std::vector<double> carried;
  for (const CutCell& cell : now.cut().cells())
    if (mine.contains(cell.cell)) carried.push_back(to.pressure(cell.cell[0], cell.cell[1], cell.cell[2]));
  bodies_->keep_cut_faces(now, to.velocity);
  correct(block_, ActiveCells::all({}), step_over_density, phi_, viscous_factor, source_, from.pressure, to.pressure,
          to.velocity);
  further_phi_.assign(now.piece_pressure.size(), 0.0);
  for (std::size_t n = 0; n < piece_phi_.size(); ++n)
    further_phi_[static_cast<std::size_t>(now.pieces().listed()[n])] = piece_phi_[n];
  bodies_->correct_cut_faces(now, step_over_density, phi_, further_phi_, to.velocity);
  std::size_t n_carried = 0;
  for (const CutCell& cell : now.cut().cells()) {
    const auto& [i, j, k] = cell.cell;
    if (mine.contains(cell.cell)) to.pressure(i, j, k) = carried[n_carried++] + phi_(i, j, k);
  }
  for (std::size_t f = 0; f < further_phi_.size(); ++f) now.piece_pressure[f] += further_phi_[f];
  bodies_->fill_piece_ghosts(ghosts_.exchange(), now);
  bodies_->still_inside(now, whole_cells_, to.velocity, to.pressure);
  // Measured after faces have their own slopes. Bodies move by one cell a step at most.
  FlowMeasure found = measure(block_, whole_cells_, to.velocity);
  found.courant_rate = std::max(found.courant_rate, courant_number_of_one_cell * bodies_->courant_rate(now));
  found.leaving = body_that_leaves(now);
  return found;
}

/// A wall that moves where fluid comes in or leaves: its number from 1, 0 where there is none.
double PressureCorrection::body_that_leaves(const BodyGeometry& now) const {
  const CutCells& cut = now.cut();
  const Box mine = box_of(block_.sizes);
  for (const WallTriangle& wall : cut.walls()) {
    const Triple& cell =
        cut.cells()[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(wall.outer_part)].cell)].cell;
    if (!mine.contains(cell) || wall.velocity.isZero() || wall.opening >= 1) continue;
    for (int d = 0; d < block_.n_dimensions; ++d)
      for (int side = 0; side < 2; ++side) {
        const bool is_beside = cell[d] == (side == 0 ? 0 : block_.sizes[d] - 1);
        if (!is_beside || !block_.decomposition->is_at_border(d, side)) continue;
        const BorderKind kind = border_.kind(d, side, cell);
        if (kind == BorderKind::opening || kind == BorderKind::outflow) return wall.surface + 1;
      }
  }
  return 0;
}

void PressureCorrection::make_solenoidal(FlowState& state) {
  if (bodies_) force_walls(state, 0, state);
  take_divergence_of(state.velocity, 1, state.bodies.get());
  const FlowMeasure given = reduce(measure(block_, measured(), state.velocity), block_.decomposition->communicator());
  if (!std::isfinite(given.divergence_sum)) require_finite(block_, state.velocity, 0);
  solve({initial_tolerance, setup_.pressure.divergence_tolerance * given.speed / smallest_width_, initial_iterations});
  const FlowMeasure measured_after = reduce(correct_velocity(state, 1, 0, state), block_.decomposition->communicator());
  n_reductions_ += 4;
  state.courant_rate = measured_after.courant_rate;
  state.largest_speed = measured_after.speed;
  if (bodies_) std::fill(state.bodies->piece_pressure.begin(), state.bodies->piece_pressure.end(), 0.0);
}

void PressureCorrection::find_pressure(VectorField& acceleration, Field<double>& pressure) {
  take_divergence_of(acceleration, setup_.density, nullptr);
  solve({initial_tolerance, 0, initial_iterations});
  for (int k = 0; k < block_.sizes[2]; ++k)
    for (int j = 0; j < block_.sizes[1]; ++j)
      for_each_interval(block_.cells, j, k, 0, block_.sizes[0], [&](int begin, int end) {
        std::copy(phi_.row(j, k) + begin, phi_.row(j, k) + end, pressure.row(j, k) + begin);
      });
}

void PressureCorrection::measure_speed(FlowState& state) {
  if (bodies_) whole_cells_ = state.bodies->cut().whole(block_.cells);  // of another state before
  const FlowMeasure found = reduce(measure(block_, measured(), state.velocity), block_.decomposition->communicator());
  n_reductions_ += 2;
  if (!std::isfinite(found.divergence_sum)) require_finite(block_, state.velocity, state.time);
  state.courant_rate = found.courant_rate;
  state.largest_speed = found.speed;
}

void PressureCorrection::take_divergence_of(VectorField& velocity, double factor, const BodyGeometry* bodies) {
  ghosts_.while_filling(velocity, false,
                        [&](const Box& box) { take_divergence(block_, box, factor, velocity, source_); });
  if (!bodies) return;
  bodies_->take_divergence(*bodies, factor, velocity, bodies_->forcing().piece_velocity(), source_, piece_source_);
  piece_phi_.assign(piece_source_.size(), 0.0);
}

/// phi from source, from nothing: equal steps give equal bits.
SolveReport PressureCorrection::solve(const SolveLimits& limits) {
  set_zero(block_, phi_);
  const SolveReport solved = solver_->solve(source_, phi_, limits, piece_source_, piece_phi_);
  border_.fill_increment_ghosts(phi_);
  return solved;
}

std::size_t PressureCorrection::n_bytes() const {
  std::size_t n = solver_->n_bytes() + source_.n_bytes() + phi_.n_bytes();
  if (problem_.open_share)
    for (const Field<float>& share : *problem_.open_share) n += share.n_bytes();
  return n;
}

Traffic PressureCorrection::traffic() const {
  Traffic all = solver_->traffic();
  all.reductions += n_reductions_;
  return all;
}

}  // namespace couplet::flow
