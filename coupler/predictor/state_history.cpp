#include "coupler/predictor/state_history.hpp"

#include <algorithm>

namespace couplet::coupling {

void StateHistory::accept(double time, const Eigen::VectorXd& state) {
  if (!times_.empty() && differences_max_ > 0) {
    if (differences_.size() < differences_max_) differences_.emplace_back();
    std::rotate(differences_.begin(), differences_.end() - 1, differences_.end());
    differences_.front() = state - last_;
  }
  times_.insert(times_.begin(), time);
  if (times_.size() > differences_max_ + 1) times_.pop_back();
  last_ = state;
}

Eigen::VectorXd StateHistory::combine(const Eigen::VectorXd& coefficients) const {
  Eigen::VectorXd state = last_;
  for (Eigen::Index i = 0; i < coefficients.size(); ++i) state += coefficients(i) * difference(i);
  return state;
}

// Lagrange: x(t) = sum_i w_i x_i, w_i = prod_{j != i} (t - t_j) / (t_i - t_j); with x_i = x_0 - d_0 - ... - d_{i-1} and
// sum w_i = 1 the coefficient of d_j is minus the sum of the weights beyond j.
Eigen::VectorXd StateHistory::polynomial(int order, double time) const {
  const int n = std::min(order, static_cast<int>(differences_.size()));
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(n);
  for (int i = 1; i <= n; ++i) {
    double weight = 1;
    for (int j = 0; j <= n; ++j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      if (j != i) weight *= (time - times_[b]) / (times_[a] - times_[b]);
    }
    coefficients.head(i).array() -= weight;
  }
  return coefficients;
}

void StateHistory::save(SavedState& state, const std::string& name) const {
  state[name + ".times"] = to_array(times_);
  state[name + ".last"] = last_;
  Eigen::MatrixXd differences(last_.size(), n_differences());
  for (Eigen::Index i = 0; i < n_differences(); ++i) differences.col(i) = difference(i);
  state[name + ".differences"] = std::move(differences);
}

void StateHistory::restore(const SavedState& state, const std::string& name) {
  times_ = to_numbers(state.at(name + ".times"));
  last_ = state.at(name + ".last");
  const Eigen::MatrixXd& differences = state.at(name + ".differences");
  differences_.clear();
  for (Eigen::Index i = 0; i < differences.cols(); ++i) differences_.emplace_back(differences.col(i));
}

}  // namespace couplet::coupling
