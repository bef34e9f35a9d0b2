#pragma once
// The elastic beam behind a rigid cylinder [Turek, Hron 2006].

#include <array>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct CylinderBeamShape {
  Eigen::Vector3d cylinder_centre{0.2, 0.2, 0.0};  // z: of the beam's back [m]
  double cylinder_radius = 0.05;                   // [m]
  double length = 0.35;                            // l: from the cylinder's rearmost point to the tip [m]
  double height = 0.02;                            // h: along y, half to either side of the centre [m]
  double depth = 0.01;                             // along z [m]
  std::array<int, 3> n_elements = {20, 2, 1};      // along x, y, z
};

/// The beam's root follows the cylinder, so that its lower and upper edges are a little longer than `length`. With the
/// defaults it ends at x = 0.6, between y = 0.19 and 0.21, as in the benchmark.
///
/// Surfaces: root (on the cylinder), tip, bottom, top, back (smallest z), front. Marker: A, the tip's middle on the
/// back, (0.6, 0.2) in the benchmark. Throws SceneError for lengths that do not fit.
SolidMesh make_cylinder_beam_mesh(const CylinderBeamShape& shape);

}  // namespace couplet::solid
