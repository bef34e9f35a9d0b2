#include "proto/scene/time_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace couplet::scene {

double TimeTable::at(double t) const {
  assert(!time.empty() && time.size() == value.size());
  const auto next = std::upper_bound(time.begin(), time.end(), t);
  if (next == time.begin()) return value.front();
  if (next == time.end()) return value.back();
  const auto i = static_cast<std::size_t>(next - time.begin());
  const double s = (t - time[i - 1]) / (time[i] - time[i - 1]);
  // Half a cosine: weight (1 - cos(pi s)) / 2, with zero slope at both rows.
  const double weight = cosine ? 0.5 * (1 - std::cos(std::numbers::pi * s)) : s;
  return value[i - 1] + weight * (value[i] - value[i - 1]);
}

double TimeTable::rate(double t) const {
  assert(!time.empty() && time.size() == value.size());
  const auto next = std::lower_bound(time.begin(), time.end(), t);
  if (next == time.begin() || next == time.end()) return 0;
  const auto i = static_cast<std::size_t>(next - time.begin());
  const double width = time[i] - time[i - 1], slope = (value[i] - value[i - 1]) / width;
  const double s = (t - time[i - 1]) / width;
  return cosine ? slope * 0.5 * std::numbers::pi * std::sin(std::numbers::pi * s) : slope;
}

}  // namespace couplet::scene
