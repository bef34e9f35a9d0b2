#include "coupler/acceleration/added_mass_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::coupling {

namespace {
constexpr double probe = 1e-3;  // relaxation of the very first iteration [1]: small against 1/(1 + mu) of strongly
                                // coupled problems, large against the noise of a solver that converges to 1e-5
}

void AddedMassEstimate::learn(const Eigen::Ref<const Eigen::VectorXd>& input_difference,
                              const Eigen::Ref<const Eigen::VectorXd>& residual_difference) {
  const double quotient = -input_difference.dot(residual_difference) / input_difference.squaredNorm();
  if (!std::isfinite(quotient)) return;
  largest_ = std::max(largest_, quotient);
  is_known_ = true;
}

double AddedMassEstimate::relaxation() const {
  if (given_relaxation_) return *given_relaxation_;
  return is_known_ ? 1 / largest_ : std::min(probe, 1 / largest_);
}

void AddedMassEstimate::save(SavedState& state) const {
  state["added_mass"] = Eigen::Vector2d(largest_, is_known_ ? 1 : 0);
}

void AddedMassEstimate::restore(const SavedState& state) {
  const Eigen::MatrixXd& saved = state.at("added_mass");
  largest_ = saved(0);
  is_known_ = saved(1) != 0;
}

}  // namespace couplet::coupling
