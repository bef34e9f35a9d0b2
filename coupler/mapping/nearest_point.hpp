#pragma once
// Each flow node follows the nearest node of the solid.

#include "coupler/mapping/interpolation.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

Interpolation follow_nearest_nodes(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid);

}  // namespace couplet::coupling
