#pragma once
// Surfaces at rest from meshes, for tests.

#include <string>

#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/surface_tessellation.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// The triangles of a mesh whose faces need no cutting.
inline BodySurface surface_of(const surface::SurfaceMesh& mesh, bool is_closed, double largest_side = 0) {
  const SurfaceTessellation tessellation(mesh, "test", {.largest_side = largest_side});
  BodySurface surface{
      .name = "test", .is_closed = is_closed, .position = {}, .velocity = {}, .triangle = {}, .opening = {}};
  surface.triangle = tessellation.triangle();
  tessellation.interpolate(mesh.node_position, surface.position);
  surface.velocity.assign(surface.position.size(), Point{});
  return surface;
}

}  // namespace couplet::flow
