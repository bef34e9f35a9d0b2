#pragma once
// Motions without deformation that supports leave free.

#include <string>

#include "solid-server/mesh/solid_mesh.hpp"
#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// Throws SceneError naming `where` when a part of the mesh can shift or turn as a whole: statics cannot say where it
/// stands. The sentence names the directions and axes.
void check_rigid_motion(const SolidMesh& mesh, const FreeComponents& free, const std::string& where);

}  // namespace couplet::solid
