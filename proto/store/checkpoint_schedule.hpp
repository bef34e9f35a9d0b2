#pragma once
// When a run writes its checkpoints.

#include <chrono>
#include <cstdint>

#include "couplet/v1/output.pb.h"

namespace couplet::store {

/// After so many accepted steps, after so many minutes, or whichever comes first; never without `output.checkpoints`.
/// Minutes are those of a clock that nobody sets. What a checkpoint costs is kept beside: minutes stretch so that
/// checkpoints never take more than a fiftieth of the run.
class CheckpointSchedule {
 public:
  using Clock = std::chrono::steady_clock;

  CheckpointSchedule(const v1::Output& output, std::int64_t first_step, Clock::time_point now = Clock::now());

  /// At the end of an accepted step.
  bool is_due(std::int64_t step, Clock::time_point now = Clock::now()) const;
  /// Whether a run that ends after this step should leave one.
  bool is_missing(std::int64_t step) const { return is_wanted_ && step > last_step_; }
  void note_written(std::int64_t step, Clock::time_point begun, Clock::time_point now = Clock::now());

  int n_written() const { return n_written_; }
  double seconds() const { return seconds_; }  // that writing took [s]

 private:
  bool is_wanted_;
  std::int64_t every_steps_;  // 0: steps do not count
  double every_seconds_;      // infinity: time does not count
  std::int64_t last_step_;
  Clock::time_point last_time_;
  int n_written_ = 0;
  double seconds_ = 0, last_seconds_ = 0;
};

}  // namespace couplet::store
