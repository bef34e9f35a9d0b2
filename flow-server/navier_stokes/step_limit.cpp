#include "flow-server/navier_stokes/step_limit.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::flow {

namespace {

/// Eigenvalues lambda = -d + i c of diffusion (d > 0) and convection must lie inside the ellipse
/// (c dt / courant)^2 + (d dt / diffusion)^2 <= 1, which lies inside the stability region of the scheme.
struct SchemeLimit {
  double courant, diffusion;
  double cost;  // of a step [ns a cell]; measured on one core at 128^3, some 30 of each for the pressure
};

SchemeLimit limit_of(TimeScheme scheme) {
  switch (scheme) {
    case TimeScheme::adams_bashforth:
      // Stable for d dt <= 1. Pure convection grows by (c dt)^4 / 4 a step [Durran, Mon. Wea. Rev. 119 (1991) 702-720]:
      // 0.2 % at 0.3, less than what diffusion takes out of the shortest waves of a resolved flow.
      return {0.3, 0.9, 60};
    case TimeScheme::crank_nicolson:
      // Stable without limit; beyond a Courant number of one the error of the factorisation and of the extrapolated
      // convecting velocity is larger than that of space.
      return {1.0, std::numeric_limits<double>::infinity(), 150};
    case TimeScheme::runge_kutta:
    case TimeScheme::automatic:
      break;
  }
  // The region of third-order Runge-Kutta cuts the axes at 1.73 i and -2.51; 1.2 leaves room for a flow that speeds up
  // within the interval, and keeps the error in time below that in space.
  return {1.2, 2.3, 85};
}

}  // namespace

std::string name_of(TimeScheme scheme) {
  switch (scheme) {
    case TimeScheme::automatic:
      return "automatic";
    case TimeScheme::adams_bashforth:
      return "adams_bashforth";
    case TimeScheme::runge_kutta:
      return "runge_kutta";
    case TimeScheme::crank_nicolson:
      return "crank_nicolson";
  }
  return "";
}

double diffusion_rate(const StretchedGrid& grid, double kinematic_viscosity) {
  double rate = 0;
  for (int d = 0; d < grid.n_dimensions; ++d) {
    // Gershgorin's circles: 4 / h^2 inside, 16/3 / h^2 in the row next to a wall (parabolic ghost).
    const StretchedAxis& axis = grid.axis[d];
    double inside = 0;
    for (int i = 0; i < axis.n_cells(); ++i)
      inside = std::max(inside, 2 / axis.width(i) * (1 / axis.distance(i - 1) + 1 / axis.distance(i)));
    const double first = axis.width(0), last = axis.width(axis.n_cells() - 1);
    const double wall = axis.is_periodic() ? 0 : 16.0 / 3 / std::min(first * first, last * last);
    rate += kinematic_viscosity * std::max(inside, wall);
  }
  return rate;
}

double longest_step(TimeScheme scheme, const StepRates& rates, const StepLimits& limits) {
  SchemeLimit limit = limit_of(scheme);
  if (!std::isnan(limits.courant)) limit.courant = limits.courant;
  const double inverse = std::hypot(rates.courant / limit.courant, rates.diffusion / limit.diffusion);
  return std::min(limits.largest, 1 / inverse);
}

StepPlan plan_steps(TimeScheme scheme, const StepRates& rates, const StepLimits& limits, double duration) {
  constexpr double largest_number = 1e9;
  const auto n_steps = [&](TimeScheme candidate) {
    // A step may be longer by what round-off adds, so that equal steps stay as many as before.
    const double ratio = duration / longest_step(candidate, rates, limits) * (1 - 1e-9);
    return static_cast<int>(std::ceil(std::clamp(ratio, 1.0, largest_number)));
  };
  if (scheme != TimeScheme::automatic) return {scheme, n_steps(scheme)};
  // Number of steps times cost of one: Adams-Bashforth for intervals that are short anyway, Runge-Kutta where
  // convection limits, Crank-Nicolson where diffusion would force many steps.
  StepPlan best{TimeScheme::adams_bashforth, n_steps(TimeScheme::adams_bashforth)};
  for (const TimeScheme candidate : {TimeScheme::runge_kutta, TimeScheme::crank_nicolson}) {
    if (candidate == TimeScheme::crank_nicolson && !rates.allows_implicit) continue;
    const int n = n_steps(candidate);
    if (n * limit_of(candidate).cost < best.n_steps * limit_of(best.scheme).cost) best = {candidate, n};
  }
  return best;
}

}  // namespace couplet::flow
