#pragma once
// A box of equal hexahedra.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct BoxShape {
  Eigen::Vector3d length = Eigen::Vector3d::Ones();  // edge lengths [m]; one corner is the origin
  std::array<int, 3> n_elements = {1, 1, 1};         // along x, y, z
};

/// Surfaces x_min, x_max, y_min, y_max, z_min, z_max; no markers.
SolidMesh make_box_mesh(const BoxShape& shape);

}  // namespace couplet::solid
