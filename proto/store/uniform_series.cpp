#include "proto/store/uniform_series.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::store {

namespace {

constexpr std::ptrdiff_t n_samples_min = 8;

/// Lagrange's cubic through samples i ... i+3.
double cubic(const double* time, const double* values, double t) {
  double sum = 0;
  for (int a = 0; a < 4; ++a) {
    double weight = 1;
    for (int b = 0; b < 4; ++b) {
      if (b != a) weight *= (t - time[b]) / (time[a] - time[b]);
    }
    sum += weight * values[a];
  }
  return sum;
}

bool is_uniform(const double* time, std::ptrdiff_t count, double step) {
  // 1e-6 of a step moves a sample by less than the round-off of a time that was summed up over a long run.
  for (std::ptrdiff_t i = 1; i < count; ++i) {
    if (std::abs(time[i] - time[i - 1] - step) > 1e-6 * step) return false;
  }
  return true;
}

/// Steps that were cut short and retried leave clusters of samples; the largest number of new samples is bounded all
/// the same.
double fine_step(const double* time, std::ptrdiff_t count, double mean_step) {
  double smallest = mean_step;
  for (std::ptrdiff_t i = 1; i < count; ++i) smallest = std::min(smallest, time[i] - time[i - 1]);
  return std::max(smallest, mean_step / 4);
}

}  // namespace

UniformSeries part_between(const std::vector<double>& time, const std::vector<double>& values, double from, double to) {
  // A sample on the edge belongs to the part, whatever the round-off of its time.
  const double slack = 1e-9 * (to - from);
  const auto first = std::lower_bound(time.begin(), time.end(), from - slack) - time.begin();
  const auto last = std::upper_bound(time.begin(), time.end(), to + slack) - time.begin();
  const auto count = last - first;
  if (count < n_samples_min)
    throw report::NumericsError("history", "only " + std::to_string(count) + " rows lie in the window", "run longer");
  const double* const t = time.data() + first;
  const double* const v = values.data() + first;
  if (!std::all_of(v, v + count, [](double value) { return std::isfinite(value); }))
    throw report::NumericsError("history", "the column is not finite everywhere");
  const double mean_step = (t[count - 1] - t[0]) / static_cast<double>(count - 1);
  if (is_uniform(t, count, mean_step)) return {t[0], mean_step, Eigen::Map<const Eigen::VectorXd>(v, count)};

  const double step = fine_step(t, count, mean_step);
  UniformSeries series{t[0], step, Eigen::VectorXd(static_cast<Eigen::Index>((t[count - 1] - t[0]) / step) + 1)};
  std::ptrdiff_t interval = 0;
  for (Eigen::Index i = 0; i < series.values.size(); ++i) {
    const double at = t[0] + step * static_cast<double>(i);
    while (interval + 2 < count && t[interval + 1] < at) ++interval;
    const auto start = std::clamp<std::ptrdiff_t>(interval - 1, 0, count - 4);
    series.values(i) = cubic(t + start, v + start, at);
  }
  return series;
}

}  // namespace couplet::store
