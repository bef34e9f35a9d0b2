#pragma once
// In which order the unknowns of a sparse symmetric matrix are eliminated, so that few new entries arise.

#include "solid-server/assembly/node_pairs.hpp"

namespace couplet::solid {

/// The elimination of nodes in a given order, before numbers are known. Nodes are counted in that order.
struct Elimination {
  std::vector<Index> parent;  // the next node that each one's elimination changes, -1: none [Liu 1990]
  std::vector<Index> n_rows;  // nodes in its column of the factor, itself included
  double n_operations = 0;    // multiplications and additions of the factorisation
};

/// `order`: the nodes that take part, first to last. `weight`: unknowns of each node of the pairs; those that take part
/// have at least one.
Elimination eliminate(const NodePairs& pairs, const std::vector<int>& weight, const std::vector<Index>& order);

/// The nodes of weight above 0 in the order of fewest operations among minimum degree (AMD) and nested dissection (by
/// METIS): the first is better for slender bodies, the second for thick ones. Throws NumericsError when memory is not
/// enough.
std::vector<Index> elimination_order(const NodePairs& pairs, const std::vector<int>& weight);

}  // namespace couplet::solid
