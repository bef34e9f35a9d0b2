#pragma once
// The last accepted states as one state and differences, and polynomials through them.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// x_0 is the last state, x_1 the one before, ...; difference i is d_i = x_i - x_{i+1}. Every prediction is x_0 + sum_i
/// c_i d_i.
class StateHistory {
 public:
  explicit StateHistory(std::size_t differences_max) : differences_max_(differences_max) {}

  void accept(double time, const Eigen::VectorXd& state);

  const Eigen::VectorXd& last() const { return last_; }
  Eigen::Index n_differences() const { return static_cast<Eigen::Index>(differences_.size()); }
  const Eigen::VectorXd& difference(Eigen::Index i) const { return differences_[static_cast<std::size_t>(i)]; }
  const std::vector<double>& times() const { return times_; }  // newest first [s]

  Eigen::VectorXd combine(const Eigen::VectorXd& coefficients) const;

  /// Coefficients c of the polynomial of that order through the last order + 1 states.
  Eigen::VectorXd polynomial(int order, double time) const;

  void save(SavedState& state, const std::string& name) const;
  void restore(const SavedState& state, const std::string& name);

 private:
  std::size_t differences_max_;
  std::vector<double> times_;  // one more than differences, once there is a state
  Eigen::VectorXd last_;
  std::vector<Eigen::VectorXd> differences_;  // newest first
};

}  // namespace couplet::coupling
