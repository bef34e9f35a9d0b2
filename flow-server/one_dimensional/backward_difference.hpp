#pragma once
// Time derivatives at the end of a step from the last values.

namespace couplet::flow {

/// df/dt at the end of the step = now f_new + before f_old + earlier f_older [1/s].
struct BackwardDifference {
  double now = 0;
  double before = 0;
  double earlier = 0;
};

/// Second-order backward difference on unequal steps; first order (backward Euler) when there is no earlier step.
/// [HNW, sec. III.5], from the parabola through the three values.
inline BackwardDifference backward_difference(double step, double previous_step, bool has_previous) {
  if (!has_previous) return {1 / step, -1 / step, 0};
  const double r = step / previous_step;
  return {(1 + 2 * r) / (1 + r) / step, -(1 + r) / step, r * r / (1 + r) / step};
}

}  // namespace couplet::flow
