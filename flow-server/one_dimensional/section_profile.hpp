#pragma once
// The shape of the flow channel at one time, as the one-dimensional flow sees it.

#include <Eigen/Core>

namespace couplet::flow {

/// Stations stand at inlet + xi_k (exit - inlet), see StationAxis.
struct SectionProfile {
  double inlet = 0;              // x of the first station; does not move [m]
  double exit = 0;               // x_b: x of the exit line [m]
  double contraction_start = 0;  // x_a: x where the contraction of the effective area begins [m]
  Eigen::ArrayXd area;           // A0: true area (n_stations) [m^2]
  Eigen::ArrayXd perimeter;      // s (n_stations) [m]
};

}  // namespace couplet::flow
