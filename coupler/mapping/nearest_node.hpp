#pragma once
// Which node of a surface is nearest to a point.

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

struct NearestNode {
  std::int64_t node = -1;
  double distance = 0;  // [m]
};

/// A tree of boxes over the nodes; a search costs about the logarithm of their number.
class NodeTree {
 public:
  explicit NodeTree(const surface::NodeArray& position);
  ~NodeTree();
  NearestNode nearest(const Eigen::Vector3d& point) const;

 private:
  struct Boxes;
  std::unique_ptr<Boxes> boxes_;
};

}  // namespace couplet::coupling
