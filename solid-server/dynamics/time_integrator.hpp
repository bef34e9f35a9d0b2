#pragma once
// What every way to advance a body answers.

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/body_equations.hpp"
#include "solid-server/dynamics/motion.hpp"

namespace couplet::solid {

/// What a step took.
struct StepWork {
  long n_substeps = 0;
  long n_iterations = 0;            // of Newton's method
  long n_factorisations = 0;        // of a tangent
  double residual = 0;              // forces out of balance over their size, the worst accepted one; 0: explicit
  bool is_cut_for_contact = false;  // substeps were, so that surfaces do not pass each other
  int n_negative_pivots = 0;        // of the tangent at the end of a static step: 0 is stable
  std::vector<double> limit_loads;  // times at which a static load turned

  void add(const StepWork& step) {
    n_substeps += step.n_substeps;
    n_iterations += step.n_iterations;
    n_factorisations += step.n_factorisations;
    residual = std::max(residual, step.residual);
    is_cut_for_contact |= step.is_cut_for_contact;
    n_negative_pivots = step.n_negative_pivots;
    limit_loads.insert(limit_loads.end(), step.limit_loads.begin(), step.limit_loads.end());
  }
};

constexpr double n_equal_steps_most = 1e7;

/// Equal steps in a duration, none of them longer than `largest` but for round-off. Throws SceneError when they are
/// more than ten million: such a step would not end.
inline int n_equal_steps(double duration, double largest) {
  const double n = std::ceil(duration / largest * (1 - 1e-12));
  if (n <= n_equal_steps_most) return std::max(1, static_cast<int>(n));
  throw report::SceneError(
      "time.step",
      report::text(duration) + " s takes " + report::text(n) + " substeps of " + report::text(largest) + " s",
      "give a shorter step or a larger solid.time_integration.largest_substep; a very large "
      "stiffness of contact makes substeps short; for slow motions take "
      "solid.time_integration.method: GENERALIZED_ALPHA or STATIC");
}

/// Called now and then in a step with the time that it has reached [s]; false: give the step up.
using StepWatch = std::function<bool(double time)>;

class TimeIntegrator {
 public:
  virtual ~TimeIntegrator() = default;

  /// From one motion over `duration` [s] to another, under an interface force, (n wetted nodes, 3) [N], that varies
  /// linearly in time to the one given at the end. `from` stays as it is, and equal arguments give equal bits, whatever
  /// was asked in between. Throws NumericsError when it cannot, Interrupted when the watch gives the step up.
  virtual StepWork advance(const Motion& from, double duration, const surface::NodeArray& interface_force,
                           Motion& to) = 0;

  /// Mass times a velocity or an acceleration, with the mass that the method moves, (n_nodes, 4).
  virtual NodeVectors mass_times(const NodeVectors& vector) const = 0;
  /// What supports exert on components that they hold: inertia minus all other forces, one number for each [N].
  virtual std::vector<double> support_force(const Motion& motion,
                                            const std::vector<HeldMotion::Component>& held) const = 0;

  virtual std::size_t memory_bytes() const = 0;

  void set_watch(StepWatch watch) { watch_ = std::move(watch); }

 protected:
  bool goes_on(double time) const { return !watch_ || watch_(time); }

 private:
  StepWatch watch_;
};

}  // namespace couplet::solid
