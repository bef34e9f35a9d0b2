#pragma once
// A shallow arch.

#include <array>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct ArchShape {
  double span = 0.1;                           // distance of the ends of the middle line [m]
  double rise = 5e-3;                          // of its crown above the ends [m]
  double thickness = 1e-3;                     // normal to the middle line [m]
  double width = 5e-3;                         // along z [m]
  std::array<int, 3> n_elements = {20, 1, 1};  // along the arch, through the thickness, along z
};

/// The middle line is y = rise sin(pi x/span) from x = 0 to span; ends are cut normal to it. Surfaces: left (x = 0),
/// right, bottom, top, back (z = 0), front (z = width). Node sets left_hinge and right_hinge: the nodes of the ends on
/// the middle line, for ends that may turn. Marker: crown, the middle of the top on the back. Throws SceneError for
/// lengths that do not fit: the thickness must be below twice the smallest radius of the middle line.
SolidMesh make_arch_mesh(const ArchShape& shape);

}  // namespace couplet::solid
