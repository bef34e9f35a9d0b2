#pragma once
// The door of all accelerations: from one fixed-point iteration to the input of the next.

#include <Eigen/Core>
#include <string>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// The interface vector stacks the accelerated fields: first the n_primary entries that determine the coefficients
/// (displacement, or displacement and force in units that make them comparable), then entries that follow with the same
/// linear combination (velocity).
struct InterfaceSize {
  Eigen::Index n_primary = 0;
  Eigen::Index n_total = 0;
};

/// The contract. In each time step: start_step, then next_input after every iteration that has not converged, then
/// accept_step or discard_step. The fixed point is x = G(x); residual r = G(x) - x. Vectors are (n_total). Nothing is
/// thrown: vectors must be finite, which the caller has made sure of.
class Acceleration {
 public:
  virtual ~Acceleration() = default;

  /// A new attempt at a step begins; differences are taken within it.
  virtual void start_step() = 0;

  /// One iteration gave output = G(input). Returns the input of the next one.
  virtual Eigen::VectorXd next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) = 0;

  /// The step has converged with this pair: what it taught is kept for later steps.
  virtual void accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) = 0;

  /// The step was thrown away: what it taught is dropped, as is everything that may have misled it.
  virtual void discard_step() = 0;

  /// Largest |dr|/|dx| - 1 seen: how many times larger the answer to a motion is than the motion itself; 0 when
  /// unknown.
  virtual double added_mass_number() const { return 0; }

  /// Everything that later steps depend on, after an accepted step.
  virtual void save(SavedState& state) const = 0;
  virtual void restore(const SavedState& state) = 0;
};

}  // namespace couplet::coupling
