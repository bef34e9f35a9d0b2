#pragma once
// What the flow needs to know of a body before it starts.

#include <optional>
#include <string>
#include <vector>

#include "flow-server/immersed/edge_strip.hpp"
#include "flow-server/immersed/prescribed_motion.hpp"
#include "flow-server/immersed/surface_topology.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// Where free edges of a sheet meet a wall.
struct AttachedEdges {
  Point low, high;  // edges whose both ends lie in this box at rest
};

struct BodySetup {
  std::string name;
  surface::SurfaceMesh mesh;             // where the body lies at rest
  bool is_closed = true;                 // else a thin sheet
  FluidSide fluid = FluidSide::outside;  // of a closed surface
  double largest_side = 0;               // of its triangles [m]; 0: the faces stay as they are
  PrescribedMotion motion;
  bool is_moved_from_outside = false;      // by a solid, say: not fixed, though no motion is prescribed
  std::optional<double> blend_width = {};  // of the layer in which the velocity is blended with the wall's, in cells
  EdgeRamp edge;                           // of a thin sheet
  double edge_conductance = 1;             // K_F of the ramp: how well its two sides are joined [1]
  std::vector<AttachedEdges> attached;
  double attached_length = 0;  // by which attached edges go on beyond the wall [m]
  /// Of a closed surface: holes whose rims lie inside other closed bodies, or beyond the grid, are closed. A solid that
  /// is held by a rigid body has no wetted surface there.
  bool closes_covered_holes = false;
  double thickness = 0;  // > 0: the sheet is treated as a closed body so thick, for comparison [m]
};

}  // namespace couplet::flow
