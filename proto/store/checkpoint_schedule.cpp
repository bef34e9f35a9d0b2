#include "proto/store/checkpoint_schedule.hpp"

#include <algorithm>
#include <limits>

namespace couplet::store {

namespace {

constexpr double largest_share = 0.02;  // of the time that passes between two checkpoints by the clock

double seconds_between(CheckpointSchedule::Clock::time_point from, CheckpointSchedule::Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

CheckpointSchedule::CheckpointSchedule(const v1::Output& output, std::int64_t first_step, Clock::time_point now)
    : is_wanted_(output.has_checkpoints()),
      every_steps_(output.checkpoints().every_steps()),
      every_seconds_(output.checkpoints().has_every_minutes() || every_steps_ == 0
                         ? 60 * output.checkpoints().every_minutes()
                         : std::numeric_limits<double>::infinity()),
      last_step_(first_step),
      last_time_(now) {}

bool CheckpointSchedule::is_due(std::int64_t step, Clock::time_point now) const {
  if (!is_wanted_ || step <= last_step_) return false;
  if (every_steps_ > 0 && step % every_steps_ == 0) return true;
  return seconds_between(last_time_, now) >= std::max(every_seconds_, last_seconds_ / largest_share);
}

void CheckpointSchedule::note_written(std::int64_t step, Clock::time_point begun, Clock::time_point now) {
  last_step_ = step;
  last_time_ = now;
  last_seconds_ = seconds_between(begun, now);
  seconds_ += last_seconds_;
  ++n_written_;
}

}  // namespace couplet::store
