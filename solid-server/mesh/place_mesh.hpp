#pragma once
// A mesh turned and moved to its place.

#include <Eigen/Geometry>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Turns and moves the nodes [m] and turns the material axes.
void place_mesh(const Eigen::Isometry3d& placement, SolidMesh& mesh);

}  // namespace couplet::solid
