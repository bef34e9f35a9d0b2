#include "coupler/acceleration/least_squares.hpp"

#include <algorithm>

namespace couplet::coupling {

TriangularFactor factorise(const Eigen::MatrixXd& columns, double filter) {
  constexpr double round_off = 1e-14;  // also without a filter a column of rounding errors is none
  const Eigen::Index n = columns.rows(), k_max = std::min(columns.rows(), columns.cols());
  TriangularFactor factor;
  factor.basis.resize(n, k_max);
  factor.triangle = Eigen::MatrixXd::Zero(k_max, k_max);
  Eigen::Index k = 0;
  for (Eigen::Index j = 0; j < columns.cols() && k < k_max; ++j) {
    Eigen::VectorXd w = columns.col(j);
    const double norm = w.norm();
    const auto q = factor.basis.leftCols(k);
    Eigen::VectorXd h = q.transpose() * w;
    w.noalias() -= q * h;
    const Eigen::VectorXd again = q.transpose() * w;
    w.noalias() -= q * again;
    const double remainder = w.norm();
    if (!(remainder > std::max(filter, round_off) * norm)) continue;
    factor.basis.col(k) = w / remainder;
    factor.triangle.col(k).head(k) = h + again;
    factor.triangle(k, k) = remainder;
    factor.kept.push_back(j);
    ++k;
  }
  factor.basis.conservativeResize(n, k);
  factor.triangle.conservativeResize(k, k);
  return factor;
}

Eigen::VectorXd minimise(const TriangularFactor& factor, const Eigen::VectorXd& rhs) {
  const Eigen::VectorXd projected = factor.basis.transpose() * rhs;
  return -factor.triangle.triangularView<Eigen::Upper>().solve(projected);
}

}  // namespace couplet::coupling
