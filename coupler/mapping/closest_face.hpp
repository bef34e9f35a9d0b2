#pragma once
// Each flow node follows the closest point of the solid's faces, by their shape functions.

#include "coupler/mapping/interpolation.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

/// The offset from the closest point to the flow node is split into the face's tangents and its normal. The tangent
/// part (where a node overhangs the surface) continues the face straight on, for at most one face; the normal part
/// becomes an arm. Needs a solid with faces.
Interpolation follow_closest_faces(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid);

}  // namespace couplet::coupling
