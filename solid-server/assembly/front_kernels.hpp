#pragma once
// Dense arithmetic inside a front: signed Cholesky of a small block, products of tiles.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace couplet::solid {

/// Part of a matrix that is stored by columns.
using Tile = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstTile = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// Columns of a small diagonal block that are factorised one by one.
constexpr int block_columns = 32;
using SmallBlock = Eigen::Matrix<double, block_columns, block_columns>;

/// target -= left S right^T with S = diag(sign).
template <class Part>
void subtract_product(Tile target, const Part& left, const Part& right, const double* sign) {
  const Eigen::Map<const Eigen::VectorXd> S(sign, right.cols());
  if ((S.array() > 0).all()) {
    target.noalias() -= left * right.transpose();
  } else {
    const Eigen::MatrixXd signed_right = right * S.asDiagonal();
    target.noalias() -= left * signed_right.transpose();
  }
}

/// The block A = L S L^T, lower triangle in place, for L; `inverse`: S L^-1, so that the rows X below the block, which
/// begin as A_below, are A_below inverse^T. `diagonal`: of the whole matrix, before any elimination. Returns the first
/// column whose pivot is not a number or below 1e-14 of the diagonal (it is taken as 1 then), or -1.
///
/// Pivots that should be 0 come out as some 1e-16 of the diagonal; those of a beam a thousand times as long as thick
/// are above 1e-13 of it.
inline int factorise_block(Tile block, const double* diagonal, double* sign, SmallBlock& inverse) {
  constexpr double smallest_pivot = 1e-14;
  const auto n = static_cast<int>(block.cols());
  int bad = -1;
  SmallBlock A;
  A.topLeftCorner(n, n) = block;
  inverse.setZero();
  for (int j = 0; j < n; ++j) {
    double pivot = A(j, j);
    if (!(std::abs(pivot) > smallest_pivot * std::abs(diagonal[j])) || !std::isfinite(pivot)) {
      if (bad < 0) bad = j;
      pivot = 1;
    }
    sign[j] = pivot > 0 ? 1 : -1;
    const double root = std::sqrt(std::abs(pivot)), scale = sign[j] / root;
    A(j, j) = root;
    const int n_below = n - j - 1;
    A.col(j).segment(j + 1, n_below) *= scale;
    for (int k = j + 1; k < n; ++k) A.col(k).segment(k, n - k) -= (sign[j] * A(k, j)) * A.col(j).segment(k, n - k);
    // Row j of L^-1: (e_j - sum_{k<j} l_jk row k) / l_jj, kept as a column here.
    inverse(j, j) = 1;
    for (int k = 0; k < j; ++k) inverse.col(j).head(k + 1) -= A(j, k) * inverse.col(k).head(k + 1);
    inverse.col(j).head(j + 1) /= root;
  }
  block.triangularView<Eigen::Lower>() = A.topLeftCorner(n, n);
  inverse.transposeInPlace();
  for (int j = 0; j < n; ++j) inverse.row(j) *= sign[j];
  return bad;
}

}  // namespace couplet::solid
