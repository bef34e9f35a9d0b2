#pragma once
// Interface quasi-Newton with an inverse Jacobian from least squares [Degroote, Bathe, Vierendeels 2009].

#include <optional>
#include <vector>

#include "coupler/acceleration/acceleration.hpp"
#include "coupler/acceleration/added_mass_estimate.hpp"
#include "coupler/acceleration/difference_basis.hpp"

namespace couplet::coupling {

struct QuasiNewtonOptions {
  Eigen::Index columns_max = 50;           // most differences kept
  int steps_reused = 10;                   // earlier steps whose differences are kept
  double filter = 1e-3;                    // dependent columns are dropped below this
  std::optional<double> first_relaxation;  // chosen from the differences when absent
};

/// With V = [differences of r], X = [differences of x], newest first, alpha = argmin |r + V alpha|:
///   x_{k+1} = x_k + X alpha + omega (r + V alpha).
/// The first part is the Newton step in the span of the differences, the second relaxes what no difference explains.
class IqnIls : public Acceleration {
 public:
  IqnIls(InterfaceSize size, QuasiNewtonOptions options);

  void start_step() override;
  Eigen::VectorXd next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void discard_step() override;
  double added_mass_number() const override { return added_mass_.added_mass_number(); }
  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  Eigen::VectorXd learn(const Eigen::VectorXd& input, const Eigen::VectorXd& residual);
  double choose_relaxation(const Eigen::VectorXd& residual, const Eigen::VectorXd& unexplained) const;
  void keep(const std::vector<Eigen::Index>& columns);
  Eigen::Index free_slot();

  InterfaceSize size_;
  QuasiNewtonOptions options_;
  AddedMassEstimate added_mass_;
  DifferenceBasis residual_differences_;   // V, primary rows
  Eigen::MatrixXd input_differences_;      // X, all rows, a column is a slot (n_total, n_slots)
  Eigen::MatrixXd secondary_differences_;  // V, secondary rows (n_total - n_primary, n_slots)
  std::vector<Eigen::Index> slot_;         // of each column, newest first
  std::vector<int> age_;                   // of each column in accepted steps
  bool has_previous_ = false;              // of this attempt
  Eigen::VectorXd previous_input_, previous_residual_;
  Eigen::VectorXd relaxed_;           // unexplained residual of the last iteration of this attempt; empty: none yet
  double relaxation_of_relaxed_ = 1;  // [1]
};

}  // namespace couplet::coupling
