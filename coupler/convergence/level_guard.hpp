#pragma once
// Refuses interface states that no run should accept: not finite, or far beyond every level seen so far.

#include <optional>
#include <string>
#include <vector>

#include "coupler/scheme/interface_layout.hpp"

namespace couplet::coupling {

/// An iteration that overflows may look converged: saturated values stop changing, and a change relative to a huge
/// value is small. Therefore the change of each field over the step is compared with the largest of: the field itself,
/// its change in any accepted step, and its change in the first iterations of this step. Growth beyond a generous
/// factor is divergence.
class LevelGuard {
 public:
  explicit LevelGuard(std::vector<Segment> segments);

  void start_step();

  /// What is wrong with the fields, or nothing. `accepted` is the state at the start of the step.
  std::optional<std::string> check(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted);

  /// The fields became the accepted ones.
  void accept(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted);

  const std::vector<double>& largest_changes() const { return largest_change_; }
  void set_largest_changes(std::vector<double> changes) { largest_change_ = std::move(changes); }

 private:
  std::vector<Segment> segments_;
  int n_checked_ = 0;                   // iterations of this attempt
  std::vector<double> first_change_;    // largest in the first iterations of this attempt, per field
  std::vector<double> largest_change_;  // of all accepted steps, per field
};

}  // namespace couplet::coupling
