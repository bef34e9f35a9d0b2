#include "flow-server/one_dimensional/glottal_flow.hpp"

#include <cassert>
#include <cmath>
#include <sstream>
#include <utility>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

GlottalSolution zero_solution(int n_stations) {
  GlottalSolution zero;
  for (auto* values : {&zero.position, &zero.effective_area, &zero.volume, &zero.velocity, &zero.pressure}) {
    values->setZero(n_stations);
  }
  return zero;
}

[[noreturn]] void refuse_exit_line(const SectionProfile& profile, bool has_contraction) {
  std::ostringstream found;
  found << "the exit line has moved to x = " << profile.exit
        << " m, which is not downstream of the inlet at x = " << profile.inlet << " m";
  if (has_contraction) found << " and of the entrance start at x = " << profile.contraction_start << " m";
  throw report::NumericsError(
      "glottal flow", found.str(),
      "the solid has moved too far or the two material lines are swapped; look at its motion before this time");
}

}  // namespace

GlottalFlow::GlottalFlow(const StationAxis& axis, const GlottalLaw& law) : axis_(&axis), law_(law) {
  const int n = axis_->n_stations();
  trial_ = history_.accepted = history_.earlier = zero_solution(n);
  for (auto* values : {&station_velocity_, &velocity_without_flow_, &velocity_per_flow_, &friction_})
    values->setZero(n);
  for (auto* values : {&drops_.lower, &drops_.upper, &drops_.rest, &drops_.recovery}) values->setZero(n - 1);
}

void GlottalFlow::start(const SectionProfile& profile, const EndPressures& pressures) {
  solve_trial(profile, pressures, BackwardDifference{});
  history_.has_earlier = false;
  std::swap(history_.accepted, trial_);
}

const GlottalSolution& GlottalFlow::solve(const SectionProfile& profile, const EndPressures& pressures,
                                          double duration) {
  const bool use_earlier = law_.time_derivative == TimeDerivative::bdf2 && history_.has_earlier;
  const BackwardDifference rate =
      law_.unsteady ? backward_difference(duration, history_.previous_step, use_earlier) : BackwardDifference{};
  trial_step_ = duration;
  solve_trial(profile, pressures, rate);
  return trial_;
}

void GlottalFlow::accept() {
  std::swap(history_.earlier, history_.accepted);
  std::swap(history_.accepted, trial_);
  history_.previous_step = trial_step_;
  history_.has_earlier = true;
}

void GlottalFlow::restore(GlottalHistory history) {
  assert(history.accepted.velocity.size() == axis_->n_stations());
  history_ = std::move(history);
}

void GlottalFlow::solve_trial(const SectionProfile& profile, const EndPressures& pressures,
                              const BackwardDifference& rate) {
  place_stations(profile, rate);
  find_effective_area(profile);
  find_velocity_line(rate);
  find_drops(profile, rate);
  const double Q = inlet_rate_that_fits(pressures);
  trial_.inlet_rate = Q;
  trial_.velocity = velocity_without_flow_ + velocity_per_flow_ * Q;
  const auto last = axis_->n_stations() - 1;
  trial_.exit_rate = trial_.effective_area[last] * (trial_.velocity[last] - station_velocity_[last]);
  find_pressure(pressures);
}

// x_k = x_inlet + xi_k (x_b - x_inlet), dx_k/dt = xi_k dx_b/dt
void GlottalFlow::place_stations(const SectionProfile& profile, const BackwardDifference& rate) {
  const bool has_contraction = law_.entrance_contraction > 0;
  if (!(profile.exit > profile.inlet) || (has_contraction && !(profile.exit > profile.contraction_start))) {
    refuse_exit_line(profile, has_contraction);
  }
  trial_.exit = profile.exit;
  const double exit_velocity =
      rate.now * profile.exit + rate.before * history_.accepted.exit + rate.earlier * history_.earlier.exit;
  trial_.position = profile.inlet + axis_->fraction() * (profile.exit - profile.inlet);
  station_velocity_ = axis_->fraction() * exit_velocity;
}

// A = alpha A0, alpha = 1 - C1 + C1 (x - x_b)^2 / (x_a - x_b)^2 between x_a and x_b, 1 upstream of x_a [Diss, eq. 6.4]
void GlottalFlow::find_effective_area(const SectionProfile& profile) {
  const double C1 = law_.entrance_contraction;
  if (C1 > 0) {
    const double length = profile.exit - profile.contraction_start;
    trial_.effective_area =
        profile.area * (1 - C1 + C1 * ((profile.exit - trial_.position) / length).min(1.0).square());
  } else {
    trial_.effective_area = profile.area;
  }
  const auto n = axis_->n_stations();
  double volume = 0;
  double smallest = trial_.effective_area[0];
  trial_.throat = 0;
  trial_.volume[0] = 0;
  for (int k = 1; k < n; ++k) {
    const double A = trial_.effective_area[k];
    volume += 0.5 * (trial_.position[k] - trial_.position[k - 1]) * (trial_.effective_area[k - 1] + A);
    trial_.volume[k] = volume;
    if (A < smallest) {
      smallest = A;
      trial_.throat = k;
    }
  }
}

// u_k = a_k + b_k Q from A_k (u_k - dx_k/dt) = Q - dVol_k/dt [Diss, eq. 5.1, integrated over x]
void GlottalFlow::find_velocity_line(const BackwardDifference& rate) {
  velocity_per_flow_ = trial_.effective_area.inverse();
  velocity_without_flow_ =
      station_velocity_ - velocity_per_flow_ * (rate.now * trial_.volume + rate.before * history_.accepted.volume +
                                                rate.earlier * history_.earlier.volume);
}

// rho (du/dt at fixed xi - dx/dt du/dx) + chi rho u du/dx + dp/dx + C0 mu (s/A)^2 u = 0 over each interval, trapezoidal
// rule [Diss, eqs. 5.2-5.5]
void GlottalFlow::find_drops(const SectionProfile& profile, const BackwardDifference& rate) {
  const double rho = law_.density;
  const int n_intervals = axis_->n_stations() - 1;
  friction_ = law_.friction_coefficient * law_.viscosity * (profile.perimeter * velocity_per_flow_).square();
  const auto old_rate = [&](int k) {  // what the last accepted velocities add to du/dt
    return rate.before * history_.accepted.velocity[k] + rate.earlier * history_.earlier.velocity[k];
  };
  for (int k = 0; k < n_intervals; ++k) {
    const double half = 0.5 * (trial_.position[k + 1] - trial_.position[k]);
    const double mesh = 0.5 * (station_velocity_[k] + station_velocity_[k + 1]);
    drops_.lower[k] = rho * (half * rate.now + mesh);
    drops_.upper[k] = rho * (half * rate.now - mesh);
    drops_.rest[k] = rho * half * (old_rate(k) + old_rate(k + 1));
    // chi = 1 up to the smallest section, chi_min after it. When the throat jumps to an equally narrow place, flow and
    // pressure elsewhere are continuous; between the two places the pressure jumps by (1 - chi_min) rho (u^2 - u_k^2)
    // / 2.
    const bool is_before_throat = k < trial_.throat;
    drops_.recovery[k] = is_before_throat ? 1.0 : law_.smallest_recovery;
    if (is_before_throat || !law_.friction_only_where_converging) {
      drops_.lower[k] += half * friction_[k];
      drops_.upper[k] += half * friction_[k + 1];
    }
  }
}

// The drop from inlet to exit (B1: to the throat) is c0 + c1 Q + c2 Q^2; of its two roots the one where it rises with
// Q.
double GlottalFlow::inlet_rate_that_fits(const EndPressures& pressures) {
  const double half_rho = 0.5 * law_.density;
  const int n_intervals = separates_at_throat(law_) ? trial_.throat : axis_->n_stations() - 1;
  double c0 = pressures.exit - pressures.inlet;
  double c1 = 0;
  double c2 = 0;
  for (int k = 0; k < n_intervals; ++k) {
    const double a = velocity_without_flow_[k], a_next = velocity_without_flow_[k + 1];
    const double b = velocity_per_flow_[k], b_next = velocity_per_flow_[k + 1];
    const double dynamic = half_rho * drops_.recovery[k];
    c0 += drops_.lower[k] * a + drops_.upper[k] * a_next + drops_.rest[k] + dynamic * (a_next * a_next - a * a);
    c1 += drops_.lower[k] * b + drops_.upper[k] * b_next + 2 * dynamic * (a_next * b_next - a * b);
    c2 += dynamic * (b_next * b_next - b * b);
  }
  const double discriminant = c1 * c1 - 4 * c2 * c0;
  trial_.clipped = discriminant < 0;
  const double slope = trial_.clipped ? 0.0 : std::sqrt(discriminant);  // d(drop)/dQ at the root
  const double Q = c1 > 0 && !trial_.clipped ? -2 * c0 / (c1 + slope) : (slope - c1) / (2 * c2);
  if (!std::isfinite(Q)) {
    std::ostringstream found;
    found << "no flow rate gives the exit pressure: drop = " << c0 << " + " << c1 << " Q + " << c2
          << " Q^2 Pa with its throat at x = " << trial_.position[trial_.throat] << " m";
    throw report::NumericsError(
        "glottal flow", found.str(),
        "the channel needs a throat downstream of its inlet; otherwise the motion of the solid has diverged");
  }
  return Q;
}

void GlottalFlow::find_pressure(const EndPressures& pressures) {
  const double half_rho = 0.5 * law_.density;
  const int n = axis_->n_stations();
  const int n_intervals = separates_at_throat(law_) ? trial_.throat : n - 1;
  double p = pressures.inlet;
  trial_.pressure[0] = p;
  for (int k = 0; k < n_intervals; ++k) {
    const double u = trial_.velocity[k], u_next = trial_.velocity[k + 1];
    p -= drops_.lower[k] * u + drops_.upper[k] * u_next + drops_.rest[k] +
         half_rho * drops_.recovery[k] * (u_next * u_next - u * u);
    trial_.pressure[k + 1] = p;
  }
  for (int k = n_intervals + 1; k < n; ++k) trial_.pressure[k] = pressures.exit;
}

}  // namespace couplet::flow
