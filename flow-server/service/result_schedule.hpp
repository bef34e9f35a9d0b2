#pragma once
// When fields are stored.

#include <cmath>
#include <limits>

namespace couplet::flow {

/// At start, start + interval, start + 2 interval, ..., each time at the first accepted step that has reached it. It
/// has no state: a resumed run stores at the same times.
struct ResultSchedule {
  double start = 0;                                           // [s]
  double interval = std::numeric_limits<double>::infinity();  // [s]; infinite: nothing is stored

  bool is_on() const { return std::isfinite(interval); }

  /// Was one of the times reached after `before`, up to and including `now`?
  bool is_due(double before, double now) const { return is_on() && n_reached(now) > n_reached(before); }

 private:
  // Times that are sums of steps carry round-off: one part in 1e9 of an interval early still counts.
  double n_reached(double t) const {
    return t < start - 1e-9 * interval ? 0 : std::floor((t - start) / interval + 1e-9) + 1;
  }
};

}  // namespace couplet::flow
