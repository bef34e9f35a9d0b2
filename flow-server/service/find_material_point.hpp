#pragma once
// Which interface node a material point of the scene means.

#include <cstdint>
#include <string>

#include "couplet/v1/geometry.pb.h"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// The node of the marker, or the node nearest to the position. Throws SceneError at `field` naming the markers there
/// are.
std::int64_t find_material_point(const v1::MaterialPoint& point, const surface::SurfaceMesh& mesh,
                                 const std::string& field);

}  // namespace couplet::flow
