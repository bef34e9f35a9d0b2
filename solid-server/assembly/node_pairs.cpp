#include "solid-server/assembly/node_pairs.hpp"

#include <algorithm>

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

/// Appends a column: its rows, rising, each once.
void close_column(std::vector<Index>& rows, NodePairs& pairs) {
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  pairs.row.insert(pairs.row.end(), rows.begin(), rows.end());
  pairs.start.push_back(static_cast<Index>(pairs.row.size()));
}

}  // namespace

Index NodePairs::find(Index a, Index b) const {
  const auto [column, below] = std::minmax(a, b);
  const auto first = row.begin() + start[at(column)], last = row.begin() + start[at(column) + 1];
  const auto found = std::lower_bound(first, last, below);
  return found != last && *found == below ? static_cast<Index>(found - row.begin()) : -1;
}

NodePairs element_pairs(const SolidMesh& mesh) {
  std::vector<std::vector<Index>> elements(at(mesh.n_nodes()));  // of each node
  for (Index element = 0; element < mesh.n_elements(); ++element)
    for (const Index node : mesh.nodes_of(element)) elements[at(node)].push_back(element);
  NodePairs pairs;
  std::vector<Index> rows;
  for (Index column = 0; column < mesh.n_nodes(); ++column) {
    rows.assign(1, column);
    for (const Index element : elements[at(column)])
      for (const Index node : mesh.nodes_of(element))
        if (node > column) rows.push_back(node);
    close_column(rows, pairs);
  }
  return pairs;
}

NodePairs with_extra_pairs(const NodePairs& pairs, const std::vector<std::pair<Index, Index>>& extra) {
  std::vector<std::vector<Index>> below(at(pairs.n_nodes()));
  for (const auto& [a, b] : extra) below[at(std::min(a, b))].push_back(std::max(a, b));
  NodePairs out;
  for (Index column = 0; column < pairs.n_nodes(); ++column) {
    std::vector<Index>& rows = below[at(column)];
    rows.insert(rows.end(), pairs.row.begin() + pairs.start[at(column)],
                pairs.row.begin() + pairs.start[at(column) + 1]);
    close_column(rows, out);
  }
  return out;
}

}  // namespace couplet::solid
