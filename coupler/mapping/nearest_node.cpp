#include "coupler/mapping/nearest_node.hpp"

#include <cmath>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <vector>

namespace couplet::coupling {

namespace {

using Box = Eigen::AlignedBox3d;
using Tree = Eigen::KdBVH<double, 3, std::int64_t>;

/// What Eigen's search asks: a lower bound for a box, and the distance of a node.
struct NodeQuery {
  using Scalar = double;
  const surface::NodeArray& position;
  Eigen::Vector3d point;
  std::int64_t node = -1;
  double squared_distance = std::numeric_limits<double>::infinity();

  double minimumOnVolume(const Box& box) const { return box.squaredExteriorDistance(point); }  // NOLINT: Eigen's name
  double minimumOnObject(std::int64_t candidate) {                                             // NOLINT
    const double found = (position.row(candidate).transpose() - point).squaredNorm();
    const bool is_nearer = found < squared_distance || (found == squared_distance && candidate < node);
    if (is_nearer) {
      node = candidate;
      squared_distance = found;
    }
    return found;
  }
};

}  // namespace

struct NodeTree::Boxes {
  surface::NodeArray position;
  Tree tree;
};

NodeTree::NodeTree(const surface::NodeArray& position) : boxes_(std::make_unique<Boxes>()) {
  boxes_->position = position;
  std::vector<std::int64_t> nodes(static_cast<std::size_t>(position.rows()));
  std::vector<Box> boxes;
  for (std::int64_t node = 0; node < position.rows(); ++node) {
    nodes[node] = node;
    boxes.emplace_back(Eigen::Vector3d(position.row(node).transpose()));
  }
  boxes_->tree.init(nodes.begin(), nodes.end(), boxes.begin(), boxes.end());
}

NodeTree::~NodeTree() = default;

NearestNode NodeTree::nearest(const Eigen::Vector3d& point) const {
  NodeQuery query{boxes_->position, point};
  Eigen::BVMinimize(boxes_->tree, query);
  return {query.node, std::sqrt(query.squared_distance)};
}

}  // namespace couplet::coupling
