#pragma once
// Refuses interface states that no run should accept: not finite, or far beyond every level seen so far.

#include <optional>
#include <string>
#include <vector>

#include "coupler/scheme/interface_layout.hpp"

namespace couplet::coupling {

/// An iteration that overflows may look converged: saturated values stop changing, and a change relative to a huge
/// value is small. Therefore the change of each field over the step is compared with the first change that an iteration
/// of this step made and with the largest change of any accepted step; growth beyond a generous factor is divergence.
class LevelGuard {
 public:
  explicit LevelGuard(std::vector<Segment> segments);

  void start_step() { first_change_.assign(segments_.size(), 0); }

  /// What is wrong with the fields, or nothing. `accepted` is the state at the start of the step.
  std::optional<std::string> check(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted);

  /// The fields became the accepted ones.
  void accept(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted);

  const std::vector<double>& largest_changes() const { return largest_change_; }
  void set_largest_changes(std::vector<double> changes) { largest_change_ = std::move(changes); }

 private:
  std::vector<Segment> segments_;
  std::vector<double> first_change_;    // of this attempt, per field; 0: none yet
  std::vector<double> largest_change_;  // of all accepted steps, per field
};

}  // namespace couplet::coupling
