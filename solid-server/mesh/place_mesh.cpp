#include "solid-server/mesh/place_mesh.hpp"

namespace couplet::solid {

void place_mesh(const Eigen::Isometry3d& placement, SolidMesh& mesh) {
  const Eigen::Matrix3d turn = placement.linear();
  mesh.node_position = (mesh.node_position * turn.transpose()).rowwise() + placement.translation().transpose();
  for (ElementBlock& block : mesh.block)
    for (MaterialAxes& axes : block.axes)
      for (Eigen::Vector3d& axis : axes) axis = turn * axis;
}

}  // namespace couplet::solid
