#include "flow-server/one_dimensional/station_axis.hpp"

#include <cassert>
#include <cmath>

namespace couplet::flow {

namespace {
// Puts a quarter of the stations on the last tenth of the way, where the glottis is.
constexpr double station_clustering = 1.7;
// The finest spacing of up to about 200 stations still has a bin of its own; beyond, a lookup walks a few stations.
constexpr int bins_at_most = 1 << 14;
}  // namespace

StationAxis::StationAxis(int n_stations) : fraction_(n_stations) {
  assert(n_stations >= 2);
  for (int k = 0; k < n_stations; ++k) {
    fraction_[k] = 1 - std::pow(1 - static_cast<double>(k) / (n_stations - 1), station_clustering);
  }
  const double finest = fraction_[n_stations - 1] - fraction_[n_stations - 2];
  const int n_bins = static_cast<int>(std::min(std::ceil(1 / finest), static_cast<double>(bins_at_most)));
  n_bins_ = n_bins;
  first_of_bin_.resize(static_cast<std::size_t>(n_bins) + 1);
  int station = 0;
  for (int bin = 0; bin <= n_bins; ++bin) {
    while (station < n_stations - 1 && fraction_[station] < bin / n_bins_) ++station;
    first_of_bin_[static_cast<std::size_t>(bin)] = station;
  }
}

}  // namespace couplet::flow
