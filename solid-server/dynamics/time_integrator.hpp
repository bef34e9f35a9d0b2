#pragma once
// What every way to advance a body answers.

#include <memory>

#include "solid-server/dynamics/body_equations.hpp"
#include "solid-server/dynamics/motion.hpp"

namespace couplet::solid {

/// What a step took.
struct StepWork {
  int n_substeps = 0;
  int n_iterations = 0;      // of Newton's method
  int n_factorisations = 0;  // of a tangent
  double residual = 0;       // forces out of balance over their size, the worst accepted one; 0: explicit
  int n_negative_pivots = 0;  // of the tangent at the end of a static step: 0 is stable
  std::vector<double> limit_loads;  // times at which a static load turned
};

class TimeIntegrator {
 public:
  virtual ~TimeIntegrator() = default;

  /// From one motion over `duration` [s] to another, under an interface force, (n wetted nodes, 3) [N], that varies
  /// linearly in time to the one given at the end. `from` stays as it is. Throws NumericsError when it cannot.
  virtual StepWork advance(const Motion& from, double duration, const surface::NodeArray& interface_force,
                           Motion& to) = 0;

  virtual double kinetic_energy(const Motion& motion) const = 0;  // [J]
  /// What supports exert on the body: inertia minus all other forces, on held components (n_nodes, 4) [N].
  virtual NodeVectors support_force(const Motion& motion) const = 0;

  /// The factors that the next step begins with: a checkpoint keeps where they come from, so that a resumed run repeats
  /// every bit. Null: none.
  virtual std::shared_ptr<const FactorOrigin> factor_origin() const { return nullptr; }
  virtual void restore_factors(const FactorOrigin&) {}
  virtual std::size_t memory_bytes() const = 0;
};

}  // namespace couplet::solid
