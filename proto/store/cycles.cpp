#include "proto/store/cycles.hpp"

#include <cmath>

namespace couplet::store {

namespace {

/// Mean over `reach` samples to both sides; its first value belongs to sample `reach`.
Eigen::VectorXd averaged(const Eigen::VectorXd& values, Eigen::Index reach) {
  const Eigen::Index width = 2 * reach + 1;
  if (values.size() < width) return {};
  Eigen::VectorXd result(values.size() - width + 1);
  for (Eigen::Index k = 0; k < result.size(); ++k) result(k) = values.segment(k, width).mean();
  return result;
}

/// Upward crossings of a level, in units of samples.
std::vector<double> upward_crossings(const Eigen::VectorXd& values, double level, double shortest_cycle) {
  std::vector<double> crossings;
  for (Eigen::Index k = 0; k + 1 < values.size(); ++k) {
    const double below = values(k) - level, above = values(k + 1) - level;
    if (!(below < 0 && above >= 0)) continue;
    const double crossing = static_cast<double>(k) + below / (below - above);
    if (crossings.empty() || crossing - crossings.back() > shortest_cycle) crossings.push_back(crossing);
  }
  return crossings;
}

double value_at(const Eigen::VectorXd& values, double sample) {
  const auto k = std::min(static_cast<Eigen::Index>(sample), values.size() - 2);
  const double share = sample - static_cast<double>(k);
  return (1 - share) * values(k) + share * values(k + 1);
}

/// Integral of the straight lines between samples, from one place to another, over their distance.
double mean_between(const Eigen::VectorXd& values, double from, double to) {
  const auto first = static_cast<Eigen::Index>(std::floor(from)) + 1, last = static_cast<Eigen::Index>(std::floor(to));
  if (first > last) return 0.5 * (value_at(values, from) + value_at(values, to));
  double sum = 0.5 * (static_cast<double>(first) - from) * (value_at(values, from) + values(first));
  for (Eigen::Index k = first; k < last; ++k) sum += 0.5 * (values(k) + values(k + 1));
  sum += 0.5 * (to - static_cast<double>(last)) * (values(last) + value_at(values, to));
  return sum / (to - from);
}

/// Height of the parabola through three samples: with differences d- and d+ to the neighbours,
/// top = v + (d+ - d-)^2 / (8 (d+ + d-)), where d = v - neighbour.
double parabola_top(const Eigen::VectorXd& values, Eigen::Index at) {
  if (at == 0 || at + 1 == values.size()) return values(at);
  const double before = values(at) - values(at - 1), after = values(at) - values(at + 1);
  const double bend = before + after;
  return bend == 0 ? values(at) : values(at) + (before - after) * (before - after) / (8 * bend);
}

Cycle measure(const UniformSeries& series, double from, double to) {
  const auto first = static_cast<Eigen::Index>(std::ceil(from)), last = static_cast<Eigen::Index>(std::floor(to));
  Eigen::Index largest = 0, smallest = 0;
  series.values.segment(first, last - first + 1).maxCoeff(&largest);
  series.values.segment(first, last - first + 1).minCoeff(&smallest);
  return {series.start + series.step * from, series.step * (to - from), mean_between(series.values, from, to),
          parabola_top(series.values, first + largest), parabola_top(series.values, first + smallest)};
}

}  // namespace

std::vector<Cycle> cut_cycles(const UniformSeries& series, double period) {
  const double samples_per_period = period / series.step;
  const auto reach = static_cast<Eigen::Index>(samples_per_period / 4);
  auto crossings = upward_crossings(averaged(series.values, reach), series.values.mean(), 0.5 * samples_per_period);
  for (double& crossing : crossings) crossing += static_cast<double>(reach);
  std::vector<Cycle> cycles;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k)
    cycles.push_back(measure(series, crossings[k], crossings[k + 1]));
  return cycles;
}

}  // namespace couplet::store
