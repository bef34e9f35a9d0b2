#pragma once
// A hollow cylinder, or a piece of it.

#include <array>
#include <numbers>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct AnnulusShape {
  double inner_radius = 1e-3, outer_radius = 2e-3;  // [m]
  double length = 1e-3;                             // along z [m]
  double angle = 2 * std::numbers::pi;              // covered from the x axis on, towards y; at most a whole turn [rad]
  std::array<int, 3> n_elements = {4, 16, 1};       // across the wall, around, along z
};

/// Around the z axis, from z = 0. All nodes stand on cylinders; midside nodes too. Surfaces: inner, outer, z_min, z_max
/// and, unless it is closed, start (in the plane y = 0) and end (x = 0 for a quarter, y = 0 for a half). Throws
/// SceneError for radii that do not fit and for elements that cover more than a quarter turn.
SolidMesh make_annulus_mesh(const AnnulusShape& shape);

}  // namespace couplet::solid
