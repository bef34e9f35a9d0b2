#include "solid-server/mesh/coincident_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace couplet::solid {

namespace {

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

struct Entry {
  std::uint64_t key;  // of a cell of the search grid; cells that share one are compared in vain, no more
  double x;
  Index node;
};

std::uint64_t key_of(const Cell& cell) {
  // Multipliers of [Teschner, Heidelberger, Mueller, Pomeranets, Gross 2003], Optimized spatial hashing.
  return (static_cast<std::uint64_t>(cell[0]) * 73856093u) ^ (static_cast<std::uint64_t>(cell[1]) * 19349663u) ^
         (static_cast<std::uint64_t>(cell[2]) * 83492791u);
}

Index root_of(std::vector<Index>& parent, Index node) {
  auto up = [&](Index n) -> Index& { return parent[static_cast<std::size_t>(n)]; };
  while (up(node) != node) node = up(node) = up(up(node));
  return node;
}

}  // namespace

double coincidence_tolerance(const NodePositions& position) {
  if (position.rows() == 0) return 0;
  return 1e-7 * (position.colwise().maxCoeff() - position.colwise().minCoeff()).norm();
}

std::vector<Index> find_coincident_nodes(const NodePositions& position, double tolerance) {
  std::vector<Index> parent(static_cast<std::size_t>(position.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  if (position.rows() == 0) return parent;

  // A node belongs to its cell of a grid a thousand times coarser than the tolerance and to the cells within the
  // tolerance. The grid begins at an odd place, because nodes of regular meshes like to stand on round ones.
  const double width = std::max(1000 * tolerance, 1e-300);
  const Eigen::RowVector3d start =
      position.colwise().minCoeff() - width * Eigen::RowVector3d(0.6180339887, 0.4142135624, 0.7320508076);
  std::vector<Entry> entries;
  entries.reserve(parent.size() + parent.size() / 16);
  for (Index node = 0; node < static_cast<Index>(position.rows()); ++node) {
    const Eigen::RowVector3d place = position.row(node) - start;
    const Cell low = ((place.array() - tolerance) / width).floor().cast<std::int64_t>().matrix();
    const Cell high = ((place.array() + tolerance) / width).floor().cast<std::int64_t>().matrix();
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k) entries.push_back({key_of({i, j, k}), place[0], node});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.x != b.x ? a.x < b.x : a.node < b.node;
  });
  for (std::size_t first = 0; first < entries.size(); ++first)
    for (std::size_t second = first + 1; second < entries.size() && entries[second].key == entries[first].key &&
                                         entries[second].x - entries[first].x <= tolerance;
         ++second) {
      const Index a = entries[first].node, b = entries[second].node;
      if ((position.row(a) - position.row(b)).norm() > tolerance) continue;
      const Index root_a = root_of(parent, a), root_b = root_of(parent, b);
      parent[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
    }
  for (std::size_t node = 0; node < parent.size(); ++node) parent[node] = root_of(parent, static_cast<Index>(node));
  return parent;
}

}  // namespace couplet::solid
