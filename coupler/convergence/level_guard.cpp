#include "coupler/convergence/level_guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace couplet::coupling {

namespace {
constexpr double growth_max =
    1e4;  // [1] iterations towards a strongly coupled solution overshoot tenfold, not ten-thousandfold
}

LevelGuard::LevelGuard(std::vector<Segment> segments)
    : segments_(std::move(segments)), first_change_(segments_.size(), 0), largest_change_(segments_.size(), 0) {}

std::optional<std::string> LevelGuard::check(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted) {
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const Segment& segment = segments_[k];
    const double change = (fields - accepted).segment(segment.offset, segment.size).norm();
    if (!std::isfinite(change)) return "the " + segment.name + " is not a finite number";
    if (first_change_[k] == 0) first_change_[k] = change;
    const double level = std::max(first_change_[k], largest_change_[k]);
    if (change > growth_max * level) {
      char factor[32];
      std::snprintf(factor, sizeof factor, "%.1e", change / level);
      return "the " + segment.name + " grew to " + factor + " times any change seen before";
    }
  }
  return std::nullopt;
}

void LevelGuard::accept(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted) {
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const Segment& segment = segments_[k];
    const double change = (fields - accepted).segment(segment.offset, segment.size).norm();
    largest_change_[k] = std::max(largest_change_[k], change);
  }
}

}  // namespace couplet::coupling
