#pragma once
// A column of a history at equally spaced times.

#include <Eigen/Core>
#include <vector>

namespace couplet::store {

struct UniformSeries {
  double start = 0;  // time of the first sample [s]
  double step = 0;   // [s]
  Eigen::VectorXd values;

  double duration() const { return step * static_cast<double>(values.size() - 1); }
};

/// The part of a column between two times. Samples that are equally spaced already are taken as they are; others are
/// interpolated by the cubic through the four nearest ones, at their mean spacing or finer. Throws NumericsError when
/// fewer than 8 samples are there or one is not finite.
UniformSeries part_between(const std::vector<double>& time, const std::vector<double>& values, double from, double to);

}  // namespace couplet::store
