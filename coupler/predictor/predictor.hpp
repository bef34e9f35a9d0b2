#pragma once
// The guess of the interface state at the end of a step, from the last accepted states.

#include <Eigen/Core>
#include <vector>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// The polynomial through the last order + 1 accepted states, for steps of any size; of lower order while the history
/// is shorter. Order 0 holds the last state.
class Predictor {
 public:
  explicit Predictor(int order) : order_(order) {}

  void accept(double time, const Eigen::VectorXd& state);

  /// At least one state must have been accepted.
  Eigen::VectorXd predict(double time) const;

  const Eigen::VectorXd& last() const { return states_.front(); }

  /// Starts anew from the last state: the motion after a jump does not continue the motion before it.
  void forget_earlier();

  void save(SavedState& state, const std::string& name) const;
  void restore(const SavedState& state, const std::string& name);

 private:
  int order_;
  std::vector<double> times_;            // newest first [s]
  std::vector<Eigen::VectorXd> states_;  // newest first
};

}  // namespace couplet::coupling
