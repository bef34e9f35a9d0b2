#include "coupler/scheme/step_size.hpp"

#include <cmath>

namespace couplet::coupling {

namespace {
constexpr int easy_steps_before_growth = 4;
// Of a step. A remainder as small as the end of a run by a rounded step leaves is joined to the last step: alone it
// would divide changes of state by next to nothing.
constexpr double sliver = 1e-3;
constexpr double equal = 1e-6;  // a last step this near to a whole one is one
}  // namespace

StepSize::StepSize(double end, double step, int halvings_max) : end_(end), step_(step), halvings_max_(halvings_max) {}

bool StepSize::is_at_end() const {
  return time_ >= end_;
}

double StepSize::next_time() const {
  return is_last() ? end_ : static_cast<double>(ticks_ + ticks_of_step()) * std::ldexp(step_, -halvings_max_);
}

// A whole step has the same bits every time, wherever it starts; the last one may be shorter.
double StepSize::duration() const {
  const double whole = std::ldexp(step_, -level_), rest = end_ - time_;
  return is_last() && std::abs(rest - whole) > equal * whole ? rest : whole;
}

bool StepSize::is_last() const {
  const double next = static_cast<double>(ticks_ + ticks_of_step()) * std::ldexp(step_, -halvings_max_);
  return next > end_ - sliver * std::ldexp(step_, -level_);
}

void StepSize::accept(bool was_easy) {
  time_ = next_time();
  ticks_ += ticks_of_step();
  easy_in_a_row_ = was_easy ? easy_in_a_row_ + 1 : 0;
  const bool doubled_starts_at_multiple = ticks_ % (2 * ticks_of_step()) == 0;
  if (level_ > 0 && easy_in_a_row_ >= easy_steps_before_growth && doubled_starts_at_multiple) {
    --level_;
    easy_in_a_row_ = 0;
  }
}

bool StepSize::halve() {
  if (level_ == halvings_max_) return false;
  ++level_;
  easy_in_a_row_ = 0;
  return true;
}

void StepSize::save(SavedState& state) const {
  state["step_size"] =
      to_array({static_cast<double>(level_), static_cast<double>(easy_in_a_row_), static_cast<double>(ticks_), time_});
}

void StepSize::restore(const SavedState& state) {
  const Eigen::MatrixXd& saved = state.at("step_size");
  level_ = static_cast<int>(saved(0));
  easy_in_a_row_ = static_cast<int>(saved(1));
  ticks_ = static_cast<std::int64_t>(saved(2));
  time_ = saved(3);
}

}  // namespace couplet::coupling
