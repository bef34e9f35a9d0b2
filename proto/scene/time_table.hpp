#pragma once
// A time table of the scene as a plain value that solvers can ask.

#include <vector>

namespace couplet::scene {

struct TimeTable {
  std::vector<double> time;  // rising [s]
  std::vector<double> value;
  bool cosine = false;  // half a cosine between rows instead of a straight line

  /// Held before the first row and after the last one.
  double at(double t) const;

  /// Per second; at a row that bends the curve, that of the part that ends there.
  double rate(double t) const;
};

}  // namespace couplet::scene
