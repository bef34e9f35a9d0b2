#pragma once
// The part of a body's boundary that touches the flow.

#include <string>
#include <vector>

#include "proto/surface/surface_mesh.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct WettedSurface {
  surface::SurfaceMesh surface;   // right-hand normals into the fluid; a region for each named surface
  std::vector<Index> solid_node;  // (n surface nodes): the node of the body at each surface node, rising
  std::vector<FaceNodes> face;    // (n_faces): the same faces by nodes of the body
};

/// Regions follow the order of the names. Markers whose nodes are not on these surfaces are left out. Throws SceneError
/// for an unknown name. No names: an empty surface.
WettedSurface make_wetted_surface(const SolidMesh& mesh, const std::vector<std::string>& names);

}  // namespace couplet::solid
