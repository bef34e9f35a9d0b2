#pragma once
// How long a step may be, and which scheme takes an interval at the least cost.

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"

namespace couplet::flow {

/// What limits a step.
struct StepRates {
  double courant = 0;           // largest sum of |u| / dx [1/s]
  double diffusion = 0;         // largest eigenvalue of the discrete diffusion [1/s]
  bool allows_implicit = true;  // lines of Crank-Nicolson do not end at bodies
};

struct StepPlan {
  TimeScheme scheme = TimeScheme::runge_kutta;  // never automatic
  int n_steps = 1;
};

std::string name_of(TimeScheme scheme);

/// nu times the sum over directions of 4 / (smallest width)^2, more beside walls [1/s].
double diffusion_rate(const StretchedGrid& grid, double kinematic_viscosity);

/// The longest stable step of a scheme, not longer than limits.largest [s].
double longest_step(TimeScheme scheme, const StepRates& rates, const StepLimits& limits);

/// The scheme (the given one, or the cheapest where it is automatic) and the number of equal steps over `duration`.
StepPlan plan_steps(TimeScheme scheme, const StepRates& rates, const StepLimits& limits, double duration);

}  // namespace couplet::flow
