#pragma once
// The direct solve on the coarsest level.

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "flow-server/poisson/multigrid_level.hpp"

namespace couplet::flow {

/// Solves div grad phi = rhs on a level that one rank holds as a whole. Parts of the fluid that are not joined to an
/// open border are singular: the mean of the right-hand side is taken out of each, and phi gets mean 0 there.
class CoarsestSolve {
 public:
  explicit CoarsestSolve(const MultigridLevel& level);

  void solve(const Field<float>& rhs, Field<float>& phi);

 private:
  struct Cell {
    int i, j, k;
  };
  void remove_means(Eigen::VectorXd& values) const;

  std::vector<Cell> cells_;
  Eigen::VectorXd volume_;
  std::vector<int> part_;           // (n_cells) which connected part of the fluid
  std::vector<bool> part_is_open_;  // has it an open border?
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
  Eigen::VectorXd right_hand_side_, solution_;
};

}  // namespace couplet::flow
