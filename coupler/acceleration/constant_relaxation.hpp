#pragma once
// x <- x + omega (G(x) - x), a factor for each entry.

#include "coupler/acceleration/acceleration.hpp"

namespace couplet::coupling {

class ConstantRelaxation : public Acceleration {
 public:
  /// `factor` (n_total), each in (0, 1].
  explicit ConstantRelaxation(Eigen::VectorXd factor);

  void start_step() override {}
  Eigen::VectorXd next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) override;
  void accept_step(const Eigen::VectorXd&, const Eigen::VectorXd&) override {}
  void discard_step() override {}
  void save(SavedState&) const override {}
  void restore(const SavedState&) override {}

 private:
  Eigen::VectorXd factor_;  // (n_total) [1]
};

}  // namespace couplet::coupling
