#pragma once
// The columns of a least-squares problem in factored form, so that adding one costs a few passes and dropping one costs
// nothing.

#include <Eigen/Core>

#include "coupler/checkpoint/saved_state.hpp"

namespace couplet::coupling {

/// V = Q B: Q (n_rows, n_basis) orthonormal, B (n_basis, n_columns) small, newest column first. A new column is
/// orthogonalised against Q by classical Gram-Schmidt done twice [Giraud, Langou, Rozloznik 2005]; a dropped one leaves
/// B only. When Q has grown well beyond the columns kept it is compressed in one product. Sums run over fixed blocks of
/// rows: equal bits every time.
class DifferenceBasis {
 public:
  DifferenceBasis(Eigen::Index n_rows, Eigen::Index columns_max);

  Eigen::Index n_columns() const { return coefficients_.cols(); }
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }  // B

  /// Puts `column` in front and returns Q^T residual with the Q that results; both are needed together and cost one
  /// pass so.
  Eigen::VectorXd add(const Eigen::VectorXd& column, const Eigen::VectorXd& residual);

  /// Q^T residual.
  Eigen::VectorXd project(const Eigen::VectorXd& residual) const;

  /// result += Q weights.
  void add_combination(const Eigen::VectorXd& weights, Eigen::Ref<Eigen::VectorXd> result) const;

  /// Keeps these columns (rising indices) and no others.
  void keep(const std::vector<Eigen::Index>& columns);

  void clear();

  void save(SavedState& state, const std::string& name) const;
  void restore(const SavedState& state, const std::string& name);

 private:
  void compress();
  auto basis(Eigen::Index row, Eigen::Index n) const { return basis_.block(row, 0, n, n_basis_); }

  Eigen::Index n_rows_;
  Eigen::Index columns_max_;
  Eigen::Index n_basis_ = 0;
  Eigen::MatrixXd basis_;         // Q in its first n_basis_ columns (n_rows rounded up, capacity)
  Eigen::MatrixXd coefficients_;  // B (n_basis, n_columns)
};

}  // namespace couplet::coupling
