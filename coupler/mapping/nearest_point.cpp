#include "coupler/mapping/nearest_point.hpp"

#include <algorithm>

#include "coupler/mapping/nearest_node.hpp"

namespace couplet::coupling {

Interpolation follow_nearest_nodes(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid) {
  const NodeTree tree(solid.node_position);
  Interpolation result;
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (std::int64_t node = 0; node < flow.n_nodes(); ++node) {
    const NearestNode nearest = tree.nearest(flow.node_position.row(node).transpose());
    entries.emplace_back(node, nearest.node, 1.0);
    result.largest_distance = std::max(result.largest_distance, nearest.distance);
  }
  result.weights.resize(flow.n_nodes(), solid.n_nodes());
  result.weights.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace couplet::coupling
