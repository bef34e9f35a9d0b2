#pragma once
// What a coupled run will say about itself in summary.json.

#include <chrono>
#include <string>
#include <vector>

#include "coupler/checkpoint/saved_state.hpp"
#include "coupler/convergence/convergence_history.hpp"
#include "coupler/mapping/mapping.hpp"
#include "coupler/scheme/time_loop.hpp"
#include "proto/store/summary.hpp"

namespace couplet::coupling {

/// The change that a criterion limits: relative where a relative limit is given or none at all, otherwise absolute; the
/// largest of all criteria.
double largest_residual(const std::vector<Criterion>& criteria, const std::vector<FieldChange>& changes);

class RunRecord {
 public:
  explicit RunRecord(std::string scene_path);

  void add(const AcceptedStep& step, double residual, const ConservationError& error);
  void note_checkpoints(int n_written, double seconds);
  void add_program(const std::string& name, const std::vector<participant::NamedNumber>& quantities);

  /// The summary so far, with the cost of this process.
  store::Summary summary(const std::string& status, const std::string& failure) const;

  /// Counts over the whole run, also when it is resumed; wall and core seconds are of this part of it.
  void save(SavedState& state) const;
  void restore(const SavedState& state);

 private:
  store::Summary summary_;
  double n_iterations_ = 0;
  std::chrono::steady_clock::time_point started_;
};

}  // namespace couplet::coupling
