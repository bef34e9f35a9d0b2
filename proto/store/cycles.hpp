#pragma once
// A series cut into its cycles.

#include <vector>

#include "proto/store/uniform_series.hpp"

namespace couplet::store {

struct Cycle {
  double start = 0;     // time of the upward crossing of the mean [s]
  double duration = 0;  // to the next one [s]
  double mean = 0;      // over the cycle
  double largest = 0;   // top of the parabola through the largest sample and its neighbours
  double smallest = 0;
};

/// Cycles from one upward crossing of the series' mean to the next. Crossings are those of the series averaged over
/// half a `period` around each sample, so that ripples and noise do not cut a cycle; two are at least half a period
/// apart. Only whole cycles count.
std::vector<Cycle> cut_cycles(const UniformSeries& series, double period);

}  // namespace couplet::store
