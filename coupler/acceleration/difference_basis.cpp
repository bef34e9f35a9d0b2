#include "coupler/acceleration/difference_basis.hpp"

#include <algorithm>
#include <vector>

#include "coupler/acceleration/least_squares.hpp"

namespace couplet::coupling {

namespace {

constexpr Eigen::Index block_rows = 512;  // a block of Q (50 columns) stays in the second-level cache between two uses

// Below this remainder a column lies in the span of Q to round-off and brings no new direction.
constexpr double round_off = 1e-14;

}  // namespace

DifferenceBasis::DifferenceBasis(Eigen::Index n_rows, Eigen::Index columns_max)
    : n_rows_(n_rows), columns_max_(columns_max), coefficients_(0, 0) {}

Eigen::VectorXd DifferenceBasis::add(const Eigen::VectorXd& column, const Eigen::VectorXd& residual) {
  if (n_basis_ >= columns_max_ + std::max<Eigen::Index>(columns_max_ / 4, 4)) compress();
  if (basis_.cols() <= n_basis_) {  // grow in steps: most problems never need columns_max
    const Eigen::Index aligned_rows = (n_rows_ + 7) / 8 * 8;
    basis_.conservativeResize(aligned_rows, std::max<Eigen::Index>(8, n_basis_ + n_basis_ / 2));
  }

  const Eigen::Index p = n_basis_;
  Eigen::VectorXd w = column;
  Eigen::VectorXd h = Eigen::VectorXd::Zero(p), g = Eigen::VectorXd::Zero(p + 1), again = Eigen::VectorXd::Zero(p);
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {  // h = Q^T v, g = Q^T r
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    h.noalias() += basis(row, n).transpose() * w.segment(row, n);
    g.head(p).noalias() += basis(row, n).transpose() * residual.segment(row, n);
  }
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {  // w = v - Q h, again = Q^T w
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    w.segment(row, n).noalias() -= basis(row, n) * h;
    again.noalias() += basis(row, n).transpose() * w.segment(row, n);
  }
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {  // w = w - Q again
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    w.segment(row, n).noalias() -= basis(row, n) * again;
  }
  h += again;

  const double remainder = w.norm();
  const bool is_new = remainder > round_off * column.norm();
  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(p + (is_new ? 1 : 0), n_columns() + 1);
  grown.block(0, 1, p, n_columns()) = coefficients_;
  grown.col(0).head(p) = h;
  if (is_new) {
    grown(p, 0) = remainder;
    basis_.col(p).head(n_rows_) = w / remainder;
    g(p) = w.dot(residual) / remainder;
    ++n_basis_;
  }
  coefficients_ = std::move(grown);
  return g.head(n_basis_);
}

Eigen::VectorXd DifferenceBasis::project(const Eigen::VectorXd& residual) const {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(n_basis_);
  if (n_basis_ == 0) return g;
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    g.noalias() += basis(row, n).transpose() * residual.segment(row, n);
  }
  return g;
}

void DifferenceBasis::add_combination(const Eigen::VectorXd& weights, Eigen::Ref<Eigen::VectorXd> result) const {
  if (n_basis_ == 0) return;
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    result.segment(row, n).noalias() += basis(row, n) * weights;
  }
}

void DifferenceBasis::keep(const std::vector<Eigen::Index>& columns) {
  Eigen::MatrixXd kept(n_basis_, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    kept.col(static_cast<Eigen::Index>(k)) = coefficients_.col(columns[k]);
  coefficients_ = std::move(kept);
  if (columns.empty()) n_basis_ = 0, coefficients_.resize(0, 0);
}

void DifferenceBasis::clear() {
  keep({});
}

// V = Q B = Q (Qhat R) = (Q Qhat) R.
void DifferenceBasis::compress() {
  const TriangularFactor factor = factorise(coefficients_, 0);
  const Eigen::Index p = factor.basis.cols();
  Eigen::MatrixXd block(block_rows, p);
  for (Eigen::Index row = 0; row < n_rows_; row += block_rows) {
    const Eigen::Index n = std::min(block_rows, n_rows_ - row);
    block.topRows(n).noalias() = basis(row, n) * factor.basis;
    basis_.block(row, 0, n, p) = block.topRows(n);
  }
  coefficients_ = factor.basis.transpose() * coefficients_;
  n_basis_ = p;
}

void DifferenceBasis::save(SavedState& state, const std::string& name) const {
  state[name + ".basis"] = basis_.block(0, 0, n_basis_ > 0 ? n_rows_ : 0, n_basis_);
  state[name + ".coefficients"] = coefficients_;
}

void DifferenceBasis::restore(const SavedState& state, const std::string& name) {
  const Eigen::MatrixXd& saved = state.at(name + ".basis");
  n_basis_ = saved.cols();
  basis_.resize((n_rows_ + 7) / 8 * 8, std::max<Eigen::Index>(8, n_basis_));
  basis_.block(0, 0, saved.rows(), n_basis_) = saved;
  coefficients_ = state.at(name + ".coefficients");
}

}  // namespace couplet::coupling
