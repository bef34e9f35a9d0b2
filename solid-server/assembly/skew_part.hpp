#pragma once
// The skew-symmetric part of a matrix whose symmetric part TangentSolver has.

#include <vector>

#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// Sparse, of 3 x 3 blocks. The order of calls: clear, any number of add, complete, any number of add_product.
class SkewPart {
 public:
  void clear() { entries_.clear(); }

  /// The skew part of a contribution C_ab (TangentSolver::add takes the symmetric one):  S_ab += C_ab / 2,
  /// S_ba -= C_ab^T / 2.
  void add(Index node_a, Index node_b, const Eigen::Matrix3d& block);

  /// Sums up what belongs to one pair of nodes, and forgets held components and what has cancelled.
  void complete(const FreeComponents& free);

  bool is_zero() const { return entries_.empty(); }
  void add_product(const NodeVectors& vector, NodeVectors& sum) const;  // sum += S vector

 private:
  struct Entry {
    Index a, b;
    Eigen::Matrix3d block;
  };
  std::vector<Entry> entries_;
};

}  // namespace couplet::solid
