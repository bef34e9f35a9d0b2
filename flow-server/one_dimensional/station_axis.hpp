#pragma once
// Where the stations stand between inlet and exit, and which of them is next to a given place.

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace couplet::flow {

/// Stations at the fractions xi_k of the way from inlet (0) to exit (1), dense towards the exit: xi = 1 - (1 - t)^c
/// with equally spaced t, c = station_clustering. The mapping is smooth, so that a second-order formula stays second
/// order.
class StationAxis {
 public:
  /// At least 2 stations.
  explicit StationAxis(int n_stations);

  int n_stations() const { return static_cast<int>(fraction_.size()); }
  const Eigen::ArrayXd& fraction() const { return fraction_; }  // (n_stations) [1]

  /// The first station whose fraction is at least xi; n_stations() when there is none.
  int first_at_or_after(double xi) const {
    if (!(xi > 0)) return 0;
    if (xi > 1) return n_stations();
    int station = first_of_bin_[static_cast<std::size_t>(xi * n_bins_)];
    while (fraction_[station] < xi) ++station;
    return station;
  }

  /// The interval k, between stations k and k + 1, in which xi lies; the nearest one when it lies outside [0, 1].
  int interval_of(double xi) const { return std::clamp(first_at_or_after(xi) - 1, 0, n_stations() - 2); }

 private:
  Eigen::ArrayXd fraction_;
  double n_bins_ = 0;
  std::vector<int>
      first_of_bin_;  // (n_bins + 1): the first station at or after the lower end of each of the equal bins
};

}  // namespace couplet::flow
