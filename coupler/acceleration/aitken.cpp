#include "coupler/acceleration/aitken.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::coupling {

namespace {
// Of the safe factor: with less the iteration stands still, and stays so because nothing new is learnt.
constexpr double smallest_share = 0.1;
}  // namespace

Aitken::Aitken(InterfaceSize size, std::optional<double> first_relaxation)
    : size_(size), added_mass_(first_relaxation) {}

Eigen::VectorXd Aitken::next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  const Eigen::VectorXd residual = output - input;
  if (!has_previous_) factor_ = added_mass_.relaxation();
  learn(input, residual);
  return input + factor_ * residual;
}

void Aitken::accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  learn(input, output - input);
  has_previous_ = false;
}

void Aitken::discard_step() {
  has_previous_ = false;
  added_mass_.doubt();
}

void Aitken::learn(const Eigen::VectorXd& input, const Eigen::VectorXd& residual) {
  if (has_previous_) {
    const Eigen::VectorXd change = (residual - previous_residual_).head(size_.n_primary);
    const double squared = change.squaredNorm();
    added_mass_.learn((input - previous_input_).head(size_.n_primary), change);
    if (squared > 0) {
      const double factor = -factor_ * previous_residual_.head(size_.n_primary).dot(change) / squared;
      const double safe = added_mass_.relaxation();
      // A factor below zero leads away from the solution wherever the fluid opposes the motion.
      factor_ = factor > 0 && std::isfinite(factor) ? std::clamp(factor, smallest_share * safe, 1.0) : safe;
    }
  }
  has_previous_ = true;
  previous_input_ = input;
  previous_residual_ = residual;
}

void Aitken::save(SavedState& state) const {
  added_mass_.save(state);
}

void Aitken::restore(const SavedState& state) {
  added_mass_.restore(state);
  has_previous_ = false;
}

}  // namespace couplet::coupling
