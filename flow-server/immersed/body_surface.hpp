#pragma once
// A surface in the flow at one time, as triangles.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"
#include "flow-server/immersed/sharp_edges.hpp"

namespace couplet::flow {

/// Positions and velocities are those of one time; which corners make a triangle never changes.
struct BodySurface {
  std::string name;
  bool is_closed = false;       // bounds a body: fluid only where the normals point to; else on both sides
  bool is_lumen = false;        // of a closed one: the fluid is inside; where there is a lumen all else is solid
  bool is_fixed = false;        // of a closed one: stays for all times where it is
  std::vector<Point> position;  // (n_corners) [m]
  std::vector<Point> velocity;  // (n_corners) [m/s]
  std::vector<std::array<int, 3>> triangle;  // corners; the right-hand normal points to the side that is called outer
  /// Of a closed surface, without those of lids over holes that no fluid reaches; empty: taken as smooth everywhere.
  std::vector<SharpEdge> sharp_edge = {};
  /// Share of the fluid that passes through the surface as if it were not there; empty: 0 everywhere. Rises linearly
  /// across a smooth free edge, where the triangles go on beyond the sheet, and further above 1 to their end: at a
  /// place between corners it is min(sum of weight opening, 1), cut off after the interpolation and nowhere else.
  std::vector<double> opening;  // (n_corners)
  /// Width of the layer in which the velocity is blended with the wall's, in cells; not set: as WallLayerSettings say.
  std::optional<double> blend_width = {};
  /// K of a smooth free edge, which joins both sides of a sheet inside a cell:
  ///     conductance = K * (integral over the wall of o / (1 - o + 0.02)) / cell width, o being the opening
  double edge_conductance = 1;  // [1]
};

}  // namespace couplet::flow
