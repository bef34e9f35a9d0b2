#pragma once
// Which pairs of nodes a symmetric matrix of 3 x 3 blocks couples.

#include <utility>
#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// The lower triangle in compressed columns: pairs (row, column) with row >= column; each node is paired with itself.
/// The blocks of a matrix are (n_pairs, 3, 3), entry (i, k) for component i of the row and k of the column.
struct NodePairs {
  std::vector<Index> start{0};  // of each column in `row`, (n_nodes + 1)
  std::vector<Index> row;       // rising in each column

  Index n_nodes() const { return static_cast<Index>(start.size()) - 1; }
  Index n_pairs() const { return static_cast<Index>(row.size()); }

  /// Place of a pair, in either order, or -1.
  Index find(Index a, Index b) const;
};

/// Nodes of a common element.
NodePairs element_pairs(const SolidMesh& mesh);

/// Also the nodes of the extra pairs, in either order, known ones too.
NodePairs with_extra_pairs(const NodePairs& pairs, const std::vector<std::pair<Index, Index>>& extra);

}  // namespace couplet::solid
