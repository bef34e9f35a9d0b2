#pragma once
// The small dense problem behind every quasi-Newton step: which columns are worth keeping, and with what weights.

#include <Eigen/Core>
#include <vector>

namespace couplet::coupling {

/// B[:, kept] = basis triangle, columns taken from the front.
struct TriangularFactor {
  Eigen::MatrixXd basis;           // (n_rows, n_kept) orthonormal
  Eigen::MatrixXd triangle;        // (n_kept, n_kept) upper triangular
  std::vector<Eigen::Index> kept;  // columns of B, rising
};

/// Gram-Schmidt from the first column to the last; a column whose remainder is at most `filter` times its norm depends
/// on those before it and is left out (QR2 filter of [Haelterman et al. 2016]).
TriangularFactor factorise(const Eigen::MatrixXd& columns, double filter);

/// Weights alpha of the kept columns that minimise |rhs + B[:, kept] alpha|.
Eigen::VectorXd minimise(const TriangularFactor& factor, const Eigen::VectorXd& rhs);

}  // namespace couplet::coupling
