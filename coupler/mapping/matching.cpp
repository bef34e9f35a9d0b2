#include "coupler/mapping/matching.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "coupler/mapping/nearest_node.hpp"

namespace couplet::coupling {

namespace {

using Partners = std::vector<std::int64_t>;  // of each flow node

std::string node_text(const std::string& side, const surface::SurfaceMesh& mesh, std::int64_t node) {
  char text[128];
  const auto position = mesh.node_position.row(node);
  std::snprintf(text, sizeof text, " node %lld at (%g, %g, %g)", static_cast<long long>(node), position(0), position(1),
                position(2));
  return side + text;
}

bool has_same_order(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid, double tolerance) {
  return flow.n_nodes() == solid.n_nodes() &&
         (flow.node_position - solid.node_position).rowwise().norm().maxCoeff() <= tolerance;
}

MatchingResult refusal(const std::string& sentence) {
  return {std::nullopt, sentence, false};
}

MatchingResult from_partners(const Partners& partner, const surface::SurfaceMesh& flow,
                             const surface::SurfaceMesh& solid, bool is_identity) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  Interpolation result;
  for (std::int64_t node = 0; node < flow.n_nodes(); ++node) {
    entries.emplace_back(node, partner[node], 1.0);
    const double distance = (flow.node_position.row(node) - solid.node_position.row(partner[node])).norm();
    result.largest_distance = std::max(result.largest_distance, distance);
  }
  result.weights.resize(flow.n_nodes(), solid.n_nodes());
  result.weights.setFromTriplets(entries.begin(), entries.end());
  return {std::move(result), "", is_identity};
}

}  // namespace

MatchingResult match_nodes(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid) {
  const Eigen::RowVector3d extent = solid.node_position.colwise().maxCoeff() - solid.node_position.colwise().minCoeff();
  const double tolerance = 1e-6 * extent.norm();
  Partners partner(static_cast<std::size_t>(flow.n_nodes()));
  if (has_same_order(flow, solid, tolerance)) {
    for (std::int64_t node = 0; node < flow.n_nodes(); ++node) partner[node] = node;
    return from_partners(partner, flow, solid, true);
  }
  const NodeTree tree(solid.node_position);
  Partners taken_by(static_cast<std::size_t>(solid.n_nodes()), -1);
  for (std::int64_t node = 0; node < flow.n_nodes(); ++node) {
    const NearestNode nearest = tree.nearest(flow.node_position.row(node).transpose());
    if (nearest.distance > tolerance)
      return refusal(node_text("flow", flow, node) + " has no partner on the solid's surface: the nearest node is " +
                     std::to_string(nearest.distance) + " m away");
    if (taken_by[nearest.node] >= 0)
      return refusal(node_text("solid", solid, nearest.node) + " has two partners on the flow's surface");
    taken_by[nearest.node] = node;
    partner[node] = nearest.node;
  }
  const auto alone = std::find(taken_by.begin(), taken_by.end(), -1) - taken_by.begin();
  if (alone < solid.n_nodes())
    return refusal(node_text("solid", solid, alone) + " has no partner on the flow's surface");
  return from_partners(partner, flow, solid, false);
}

}  // namespace couplet::coupling
