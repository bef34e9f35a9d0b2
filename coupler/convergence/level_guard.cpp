#include "coupler/convergence/level_guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace couplet::coupling {

namespace {

// Iterations towards a strongly coupled solution overshoot tenfold, not ten-thousandfold.
constexpr double growth_max = 1e4;  // [1]

// The first answers set the level: the first one or two may be those to a tiny probe.
constexpr int n_first = 3;

}  // namespace

LevelGuard::LevelGuard(std::vector<Segment> segments)
    : segments_(std::move(segments)), first_change_(segments_.size(), 0), largest_change_(segments_.size(), 0) {}

void LevelGuard::start_step() {
  n_checked_ = 0;
  first_change_.assign(segments_.size(), 0);
}

std::optional<std::string> LevelGuard::check(const Eigen::VectorXd& fields, const Eigen::VectorXd& accepted) {
  ++n_checked_;
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const Segment& segment = segments_[k];
    const double change = (fields - accepted).segment(segment.offset, segment.size).norm();
    if (!std::isfinite(change)) return "the " + segment.name + " is not a finite number";
    if (n_checked_ <= n_first) first_change_[k] = std::max(first_change_[k], change);
    const double size = accepted.segment(segment.offset, segment.size).norm();
    const double level = std::max({size, largest_change_[k], first_change_[k]});
    if (change > growth_max * level) {
      char factor[32];
      std::snprintf(factor, sizeof factor, "%.1e", change / level);
      return "the " + segment.name + " changed by " + factor + " times any level seen before";
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
