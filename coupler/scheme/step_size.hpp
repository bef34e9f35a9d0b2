#pragma once
// The steps of a run: multiples of the scene's step where possible, halved when a step fails, grown back when steps are
// easy.

#include <cstdint>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// Time is counted in ticks of step / 2^halvings_max, so that halved and doubled steps land on the scene's steps
/// exactly and equal histories of halvings give equal bits. A step of 2^-level of the scene's step starts at a multiple
/// of itself.
class StepSize {
 public:
  StepSize(double end, double step, int halvings_max);

  bool is_at_end() const;
  double time() const { return time_; }  // of the accepted state [s]
  double next_time() const;              // after the next step [s]; never beyond the end
  double duration() const;               // of the next step [s]

  /// The next step has been accepted; after enough easy ones in a row the step doubles where that lands on a multiple.
  void accept(bool was_easy);

  /// Halves the step. False when it is at its floor already.
  bool halve();

  int level() const { return level_; }

  void save(SavedState& state) const;
  void restore(const SavedState& state);

 private:
  bool is_last() const;
  std::int64_t ticks_of_step() const { return std::int64_t{1} << (halvings_max_ - level_); }

  double end_, step_;  // [s]
  int halvings_max_;
  int level_ = 0;
  int easy_in_a_row_ = 0;
  std::int64_t ticks_ = 0;  // accepted
  double time_ = 0;         // [s]
};

}  // namespace couplet::coupling
