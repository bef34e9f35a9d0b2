#pragma once
// The elimination of a sparse symmetric matrix as a tree of small dense ones.

#include <cstdint>

#include "solid-server/assembly/node_pairs.hpp"
#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// A front is a dense matrix of the unknowns that it eliminates (its columns) and of those that the elimination changes
/// (the rows below them). What it leaves on these is added to the front of its parent [Duff, Reid 1983]. Unknowns are
/// the free components in the order of elimination. Columns of nearly the same rows share a front; some zeros are kept
/// so that fronts do not become too small.
struct FrontTree {
  struct Front {
    Index first_column = 0, n_columns = 0;
    std::size_t first_row = 0;  // of the rows below, in `row`
    Index n_rows = 0;           // below the columns
    Index parent = -1;
    Index first_child = 0, last_child = 0;  // in `child`
    std::size_t first_run = 0, last_run = 0;
    std::size_t first_entry = 0, last_entry = 0;
    std::size_t place = 0;    // of its columns in the factor, in doubles: (n_columns, leading) by columns
    double n_operations = 0;  // multiplications and additions

    Index size() const { return n_columns + n_rows; }
    Index leading() const { return padded(size()); }
  };
  /// Rows below a front's columns that follow each other in the front of its parent too.
  struct Run {
    Index from, to, length;
  };
  /// Where a block of the matrix goes in a front. Only its free components do: bits 0-2 of a mask.
  struct Entry {
    Index pair, row, column;
    std::uint8_t free_of_row, free_of_column;
    bool is_transposed;
  };

  Index n_unknowns = 0;
  std::vector<Index> unknown;  // of each node and component, -1 where it is held, (n_nodes, 3)
  std::vector<Front> front;    // children before parents; the columns of one follow those of the one before
  std::vector<Index> row, child;
  std::vector<Run> run;
  std::vector<Entry> entry;     // columns rising in each front
  std::size_t factor_size = 0;  // [doubles]
  std::size_t update_size = 0;  // of all the rows below columns, each front's padded [doubles]

  /// Branches that may be worked on at the same time, each a range [first, last) of fronts, the dearest first; the
  /// fronts that are left come after all of them, children before parents.
  struct Branch {
    Index first, last;
  };
  std::vector<Branch> branch;
  std::vector<Index> trunk;

  /// To whole cache lines, so that results do not depend on where an array lies.
  static constexpr Index padded(Index n) { return (n + 7) / 8 * 8; }
};

/// `order`: the nodes with a free component, from elimination_order.
FrontTree make_front_tree(const NodePairs& pairs, const FreeComponents& free, const std::vector<Index>& order);

/// Free components of each node.
std::vector<int> n_free_of_nodes(const FreeComponents& free);

}  // namespace couplet::solid
