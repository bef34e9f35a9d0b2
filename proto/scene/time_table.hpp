#pragma once
// A time table of the scene as a plain value that solvers can ask.

#include <vector>

#include "couplet/v1/geometry.pb.h"

namespace couplet::scene {

struct TimeTable {
  std::vector<double> time;   // rising
  std::vector<double> value;
  bool cosine = false;

  /// Held before the first row and after the last one.
  double at(double t) const;
};

TimeTable make_time_table(const v1::TimeTable& table);

}  // namespace couplet::scene
