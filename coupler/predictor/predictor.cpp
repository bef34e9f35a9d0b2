#include "coupler/predictor/predictor.hpp"

#include <algorithm>
#include <string>

namespace couplet::coupling {

void Predictor::accept(double time, const Eigen::VectorXd& state) {
  const std::size_t n_kept = static_cast<std::size_t>(order_) + 1;
  if (times_.size() < n_kept) {
    times_.emplace_back();
    states_.emplace_back();
  }
  std::rotate(times_.begin(), times_.end() - 1, times_.end());
  std::rotate(states_.begin(), states_.end() - 1, states_.end());
  times_.front() = time;
  states_.front() = state;
}

// Lagrange: x(t) = sum_i x_i prod_{j != i} (t - t_j) / (t_i - t_j).
Eigen::VectorXd Predictor::predict(double time) const {
  Eigen::VectorXd prediction = Eigen::VectorXd::Zero(states_.front().size());
  for (std::size_t i = 0; i < times_.size(); ++i) {
    double weight = 1;
    for (std::size_t j = 0; j < times_.size(); ++j) {
      if (j != i) weight *= (time - times_[j]) / (times_[i] - times_[j]);
    }
    prediction += weight * states_[i];
  }
  return prediction;
}

void Predictor::forget_earlier() {
  times_.resize(1);
  states_.resize(1);
}

void Predictor::save(SavedState& state, const std::string& name) const {
  const auto n = static_cast<Eigen::Index>(times_.size());
  state[name + ".times"] = Eigen::Map<const Eigen::VectorXd>(times_.data(), n);
  Eigen::MatrixXd states(states_.front().size(), n);
  for (Eigen::Index k = 0; k < n; ++k) states.col(k) = states_[static_cast<std::size_t>(k)];
  state[name + ".states"] = states;
}

void Predictor::restore(const SavedState& state, const std::string& name) {
  const Eigen::MatrixXd& times = state.at(name + ".times");
  const Eigen::MatrixXd& states = state.at(name + ".states");
  times_.assign(times.data(), times.data() + times.size());
  states_.clear();
  for (Eigen::Index k = 0; k < states.cols(); ++k) states_.push_back(states.col(k));
}

}  // namespace couplet::coupling
