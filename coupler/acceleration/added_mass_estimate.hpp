#pragma once
// How strongly the flow answers the motion, seen from secants; the first relaxation follows from it.

#include <optional>

#include "coupler/acceleration/acceleration.hpp"

namespace couplet::coupling {

/// For G(x) = -mu x + c the residual r = G(x) - x obeys dr = -(1 + mu) dx: relaxation by 1/(1 + mu) solves this
/// direction at once and every direction with a smaller mu converges. mu is the added-mass number of a direction:
/// apparent mass of the fluid over mass of the solid. Until a secant has been seen the step is a small probe, which no
/// mu can turn into a large one.
class AddedMassEstimate {
 public:
  explicit AddedMassEstimate(std::optional<double> given_relaxation) : given_relaxation_(given_relaxation) {}

  /// Learns from a difference of inputs and of residuals (primary entries).
  void learn(const Eigen::Ref<const Eigen::VectorXd>& input_difference,
             const Eigen::Ref<const Eigen::VectorXd>& residual_difference);

  /// Factor for the part of a residual that nothing else explains.
  double relaxation() const;

  /// Largest seen; 0 when unknown.
  double added_mass_number() const { return largest_ > 1 ? largest_ - 1 : 0; }

  /// A step was thrown away: be careful again.
  void doubt() { is_known_ = false; }

  void save(SavedState& state) const;
  void restore(const SavedState& state);

 private:
  std::optional<double> given_relaxation_;
  double largest_ = 1;  // largest 1 + mu seen [1]
  bool is_known_ = false;
};

}  // namespace couplet::coupling
