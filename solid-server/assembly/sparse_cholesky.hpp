#pragma once
// A sparse symmetric matrix of 3 x 3 blocks: factorised and solved, on all members of a team.

#include <atomic>
#include <memory>
#include <vector>

#include "solid-server/assembly/front_tree.hpp"

namespace couplet::solid {

class WorkTeam;

/// A = L S L^T with S = diag(+1, -1): the Cholesky factorisation of a positive definite matrix (S = I), and without
/// row exchanges also that of an indefinite one, whose negative eigenvalues are as many as there are -1 (Sylvester's
/// law of inertia). Multifrontal [Duff, Reid 1983; Liu 1992]: dense matrices along the tree of elimination, branches
/// side by side, then its trunk by all members together. Every sum is formed in an order that does not depend on the
/// number of members.
class SparseCholesky {
 public:
  /// Finds the order of elimination and the tree. Throws NumericsError when memory is not enough.
  SparseCholesky(const NodePairs& pairs, const FreeComponents& free, WorkTeam& team);

  /// `blocks`: (n_pairs, 3, 3), the order of the pairs. Throws NumericsError when the matrix is singular (a pivot below
  /// 1e-14 of its diagonal entry) or has an entry that is not a number, naming the node.
  void factorise(const std::vector<double>& blocks);

  int n_negative_pivots() const { return n_negative_; }

  /// Of vectors (n_nodes, 4): 0 where a component is held.
  NodeVectors solve(const NodeVectors& rhs) const;

  Index n_unknowns() const { return tree_.n_unknowns; }
  double n_operations() const { return n_operations_; }  // of a factorisation: multiplications and additions
  std::size_t n_factor_entries() const { return tree_.factor_size; }
  std::size_t memory_bytes() const;

 private:
  struct AlignedDelete {
    void operator()(double* values) const;
  };
  using Values = std::unique_ptr<double[], AlignedDelete>;
  /// Aligned to cache lines; null when there is no memory.
  static Values allocate(std::size_t n);

  struct Crew;  // the members that work on a front together
  void work(int member, const std::vector<double>& blocks);
  void eliminate(const Crew& crew, Index f, const std::vector<double>& blocks);
  void fill(const Crew& crew, Index f, const std::vector<double>& blocks);
  void take_child(const Crew& crew, Index f, Index child);
  void factorise_columns(const Crew& crew, Index f);
  void update_rows(const Crew& crew, Index f);
  void solve_forward(Index f, double* unknowns, double* updates) const;
  void solve_backward(Index f, double* unknowns) const;
  [[noreturn]] void refuse_pivot() const;
  [[noreturn]] void refuse_size() const;

  FrontTree tree_;
  WorkTeam& team_;
  double n_operations_ = 0;
  std::vector<std::size_t> update_place_;    // of each front's rows among those of all fronts
  std::vector<std::size_t> diagonal_place_;  // of each unknown's diagonal entry in the blocks
  Values factor_;                            // L, front by front
  std::vector<Values> update_;               // what a front leaves to its parent, (n_rows, n_rows) by columns
  std::vector<double> sign_;                 // S, (n_unknowns)
  std::vector<double> diagonal_;             // of the matrix, (n_unknowns)
  std::atomic<std::size_t> next_branch_{0};
  std::atomic<bool> lacks_memory_{false};
  std::atomic<Index> bad_unknown_{-1};  // the first with a pivot that cannot be used
  int n_negative_ = 0;
};

}  // namespace couplet::solid
