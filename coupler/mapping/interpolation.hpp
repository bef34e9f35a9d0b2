#pragma once
// What every kind of mapping boils down to: weights, and arms for flow nodes that stand off the solid's faces.

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "coupler/mapping/normal_arm.hpp"

namespace couplet::coupling {

using Weights = Eigen::SparseMatrix<double, Eigen::RowMajor, std::int64_t>;

struct Interpolation {
  Weights weights;              // (n_flow, n_solid), rows sum to 1
  std::vector<NormalArm> arms;  // at most one a flow node
  double largest_distance = 0;  // of a flow node from the point that it follows [m]
};

}  // namespace couplet::coupling
