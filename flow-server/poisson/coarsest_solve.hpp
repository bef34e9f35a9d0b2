#pragma once
// The direct solve on the coarsest level.

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <optional>
#include <vector>

#include "flow-server/poisson/multigrid_level.hpp"

namespace couplet::flow {

/// Solves div grad phi = rhs on a level that one rank holds as a whole, pieces of split cells included. Parts of the
/// fluid that are not joined to an open border are singular: the mean of the right-hand side is taken out of each, and
/// phi gets mean 0 there.
class CoarsestSolve {
 public:
  explicit CoarsestSolve(const MultigridLevel& level);

  /// From the right-hand sides of that level to its corrections.
  void solve(MultigridLevel& level);

  /// phi of that level becomes the number of the sealed part that an unknown belongs to, from 1 on; -1 in others.
  void number_parts(MultigridLevel& level) const;
  int n_parts() const { return static_cast<int>(part_is_open_.size()); }
  int n_sealed() const { return static_cast<int>(std::count(part_is_open_.begin(), part_is_open_.end(), false)); }

 private:
  struct Cell {
    int i, j, k;
  };
  void remove_means(Eigen::VectorXd& values) const;

  std::vector<Cell> cells_;
  std::vector<int> pieces_;  // of this rank, as the level numbers them; their rows follow those of the cells
  Eigen::VectorXd volume_;
  std::vector<int> part_;           // (n_rows) which connected part of the fluid
  std::vector<bool> part_is_open_;  // has it an open border?
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
  Eigen::VectorXd right_hand_side_, solution_;
};

}  // namespace couplet::flow
