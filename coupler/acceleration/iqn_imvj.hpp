#pragma once
// Interface quasi-Newton that carries the inverse Jacobian itself from step to step [Lindner et al. 2015].

#include <deque>
#include <optional>
#include <vector>

#include "coupler/acceleration/acceleration.hpp"
#include "coupler/acceleration/added_mass_estimate.hpp"
#include "coupler/acceleration/iqn_ils.hpp"

namespace couplet::coupling {

/// x_{k+1} = x_k - K r with K = -omega I + sum_i A_i Z_i^T: every step adds the change of least norm that fits its
/// differences,
///   A = X - K_before V,  Z^T = R^{-1} Q^T,  V = Q R.
/// K is never formed; when the steps hold more than columns_max columns the oldest are forgotten. steps_reused has no
/// meaning here.
class IqnImvj : public Acceleration {
 public:
  IqnImvj(InterfaceSize size, QuasiNewtonOptions options);

  void start_step() override;
  Eigen::VectorXd next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void discard_step() override;
  double added_mass_number() const override { return added_mass_.added_mass_number(); }
  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  struct Differences {         // of one step, newest first
    Eigen::MatrixXd input;     // X, all rows (n_total, n_columns)
    Eigen::MatrixXd residual;  // V, all rows (n_total, n_columns)
  };
  struct Update {
    Eigen::MatrixXd correction;  // A (n_total, n_columns)
    Eigen::MatrixXd dual;        // Z (n_primary, n_columns)
  };

  void learn(const Eigen::VectorXd& input, const Eigen::VectorXd& residual);
  Eigen::VectorXd carried(const Eigen::VectorXd& residual) const;  // -K r of the steps before
  Update make_update(const Differences& step) const;
  void forget_older_half();

  InterfaceSize size_;
  QuasiNewtonOptions options_;
  AddedMassEstimate added_mass_;
  std::deque<Differences> steps_;  // oldest first
  std::vector<Update> updates_;    // one for each of these steps
  double relaxation_ = 0;          // omega of this step [1]
  Differences attempt_;
  bool has_previous_ = false;
  Eigen::VectorXd previous_input_, previous_residual_;
};

}  // namespace couplet::coupling
