#pragma once
// Aitken's dynamic relaxation.

#include <optional>

#include "coupler/acceleration/acceleration.hpp"
#include "coupler/acceleration/added_mass_estimate.hpp"

namespace couplet::coupling {

/// omega_k = -omega_{k-1} r_{k-1}^T (r_k - r_{k-1}) / |r_k - r_{k-1}|^2 [Kuettler, Wall 2008, eq. 44]; the first factor
/// of a step is the last of the step before, at most the safe one of the added-mass estimate.
class Aitken : public Acceleration {
 public:
  Aitken(InterfaceSize size, std::optional<double> first_relaxation);

  void start_step() override { has_previous_ = false; }
  Eigen::VectorXd next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void discard_step() override;
  double added_mass_number() const override { return added_mass_.added_mass_number(); }
  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  void learn(const Eigen::VectorXd& input, const Eigen::VectorXd& residual);

  InterfaceSize size_;
  AddedMassEstimate added_mass_;
  double factor_ = 0;  // omega [1]; 0: none yet
  bool has_previous_ = false;
  Eigen::VectorXd previous_input_, previous_residual_;
};

}  // namespace couplet::coupling
