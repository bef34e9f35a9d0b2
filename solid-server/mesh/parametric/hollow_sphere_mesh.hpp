#pragma once
// An eighth of a hollow sphere.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct HollowSphereShape {
  double inner_radius = 1e-3, outer_radius = 2e-3;  // [m]
  int n_radial = 4;                                 // elements across the wall
  int n_around = 4;                                 // elements along half an edge of the eighth
};

/// The part x, y, z >= 0 around the origin, of three patches that meet on the diagonal: an eighth of a cube's surface
/// blown up, divided evenly by angle. All nodes stand on spheres; midside nodes too. Surfaces: inner, outer, x_min,
/// y_min, z_min (the planes of symmetry). Throws SceneError for radii that do not fit.
SolidMesh make_hollow_sphere_mesh(const HollowSphereShape& shape);

}  // namespace couplet::solid
