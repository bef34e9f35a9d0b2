#pragma once
// The door of all predictors: the interface state at the end of a step, guessed from the last accepted states.

#include <Eigen/Core>
#include <string>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// The contract. accept is called with every accepted state, times rising; predict for a later time, after at least one
/// accept. Steps may differ in size.
class Predictor {
 public:
  virtual ~Predictor() = default;

  virtual void accept(double time, const Eigen::VectorXd& state) = 0;
  virtual Eigen::VectorXd predict(double time) const = 0;

  /// The last accepted state.
  virtual const Eigen::VectorXd& last() const = 0;

  /// Everything that later predictions depend on; entries start with `name`.
  virtual void save(SavedState& state, const std::string& name) const = 0;
  virtual void restore(const SavedState& state, const std::string& name) = 0;
};

}  // namespace couplet::coupling
