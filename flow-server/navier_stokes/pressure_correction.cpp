#include "flow-server/navier_stokes/pressure_correction.hpp"

#include <algorithm>
#include <cmath>
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

using report::text;

double smallest_width_of(const StretchedGrid& grid) {
  double width = std::numeric_limits<double>::infinity();
  for (int d = 0; d < grid.n_dimensions; ++d) width = std::min(width, grid.axis[d].smallest_width());
  return width;
}

}  // namespace

PressureCorrection::PressureCorrection(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border,
                                       FlowGhosts& ghosts)
    : setup_(setup),
      block_(block),
      border_(border),
      ghosts_(ghosts),
      problem_(make_pressure_problem(setup, block, border)),
      solver_(make_pressure_solver(problem_, setup.pressure.method)),
      source_(block.new_field()),
      phi_(block.new_field()),
      smallest_width_(smallest_width_of(setup.grid)) {}

PressureCorrection::Result PressureCorrection::correct_step(const FlowState& from, double dt, FlowState& to) {
  take_divergence_of(to.velocity, setup_.density / dt);
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
  result.measure = reduce(
      correct(block_, dt / setup_.density, phi_, viscous_factor, source_, from.pressure, to.pressure, to.velocity),
      block_.decomposition->communicator());
  n_reductions_ += 2;
  const FlowMeasure& measure = result.measure;
  to.time = from.time + dt;
  to.pressure_time = from.time + 0.5 * dt;
  to.last_step = dt;
  to.courant_rate = measure.courant_rate;
  to.largest_speed = measure.speed;
  ghosts_.fill(to);

  if (!std::isfinite(measure.divergence_sum)) require_finite(block_, to.velocity, to.time);
  if (measure.divergence * smallest_width_ > largest_divergence * std::max(measure.speed, speed_at_rest))
    throw report::NumericsError("pressure at t = " + text(to.time) + " s",
                                "leaves a divergence of " + text(measure.divergence) + " 1/s in a flow of " +
                                    text(measure.speed) + " m/s on cells of " + text(smallest_width_) + " m",
                                "allow more iterations, a smaller tolerance or a smaller step");
  return result;
}

void PressureCorrection::make_solenoidal(FlowState& state) {
  take_divergence_of(state.velocity, 1);
  const FlowMeasure given = reduce(measure(block_, state.velocity), block_.decomposition->communicator());
  if (!std::isfinite(given.divergence_sum)) require_finite(block_, state.velocity, 0);
  solve({initial_tolerance, setup_.pressure.divergence_tolerance * given.speed / smallest_width_, initial_iterations});
  const FlowMeasure measured =
      reduce(correct(block_, 1, phi_, 0, source_, state.pressure, state.pressure, state.velocity),
             block_.decomposition->communicator());
  n_reductions_ += 4;
  state.courant_rate = measured.courant_rate;
  state.largest_speed = measured.speed;
}

void PressureCorrection::find_pressure(VectorField& acceleration, Field<double>& pressure) {
  take_divergence_of(acceleration, setup_.density);
  solve({initial_tolerance, 0, initial_iterations});
  for (int k = 0; k < block_.sizes[2]; ++k)
    for (int j = 0; j < block_.sizes[1]; ++j)
      for_each_interval(block_.cells, j, k, 0, block_.sizes[0], [&](int begin, int end) {
        std::copy(phi_.row(j, k) + begin, phi_.row(j, k) + end, pressure.row(j, k) + begin);
      });
}

void PressureCorrection::measure_speed(FlowState& state) {
  const FlowMeasure measured = reduce(measure(block_, state.velocity), block_.decomposition->communicator());
  n_reductions_ += 2;
  if (!std::isfinite(measured.divergence_sum)) require_finite(block_, state.velocity, state.time);
  state.courant_rate = measured.courant_rate;
  state.largest_speed = measured.speed;
}

void PressureCorrection::take_divergence_of(VectorField& velocity, double factor) {
  ghosts_.while_filling(velocity, false,
                        [&](const Box& box) { take_divergence(block_, box, factor, velocity, source_); });
}

/// phi from source, from nothing: equal steps give equal bits.
SolveReport PressureCorrection::solve(const SolveLimits& limits) {
  set_zero(block_, phi_);
  const SolveReport solved = solver_->solve(source_, phi_, limits);
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
