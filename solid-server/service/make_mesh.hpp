#pragma once
// From the mesh of a body in a scene to nodes and elements.

#include <filesystem>

#include "couplet/v1/solid.pb.h"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// `where`: the path of the body in the scene, for messages; mesh files start from `scene_folder`. Throws SceneError.
SolidMesh make_mesh(const v1::Body& body, const std::string& where, const std::filesystem::path& scene_folder);

}  // namespace couplet::solid
