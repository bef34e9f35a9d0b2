#pragma once
// A sparse symmetric matrix of 3 x 3 blocks: factorised and solved by CHOLMOD.

#include <memory>
#include <vector>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/node_pairs.hpp"
#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// A part of a body is free to move, or the body is about to buckle: a shorter step may do.
class SingularMatrix : public report::NumericsError {
 public:
  using NumericsError::NumericsError;
};

/// A = L L^T by supernodes [Chen, Davis, Hager, Rajamanickam 2008]. A matrix that is not positive definite becomes
/// L D L^T, column by column and much slower, without row exchanges; it has as many negative eigenvalues as D
/// (Sylvester's law of inertia). The order of elimination is the better one of minimum degree (AMD), which suits
/// slender bodies, and nested dissection (METIS), which suits thick ones. One thread: results depend on nothing else.
class SparseCholesky {
 public:
  /// Finds the order of elimination on the free components. Throws NumericsError when memory is not enough.
  SparseCholesky(const NodePairs& pairs, const FreeComponents& free);
  ~SparseCholesky();
  SparseCholesky(const SparseCholesky&) = delete;
  SparseCholesky& operator=(const SparseCholesky&) = delete;

  /// `blocks`: (n_pairs, 3, 3), the order of the pairs. Throws SingularMatrix for a pivot below 1e-14 of the largest,
  /// NumericsError when it has an entry that is not a number, or when memory is not enough.
  void factorise(const std::vector<double>& blocks);

  /// Of the factorised matrix; 0: positive definite.
  int n_negative_pivots() const;

  /// Of vectors (n_nodes, 4): 0 where a component is held.
  NodeVectors solve(const NodeVectors& rhs) const;

  Index n_unknowns() const;
  double n_operations() const;  // of a factorisation by supernodes: multiplications and additions
  std::size_t n_factor_entries() const;
  std::size_t memory_bytes() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace couplet::solid
