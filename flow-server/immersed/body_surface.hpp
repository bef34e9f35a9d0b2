#pragma once
// A surface in the flow at one time, as triangles.

#include <array>
#include <string>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow {

/// Positions and velocities are those of one time; which corners make a triangle never changes.
struct BodySurface {
  std::string name;
  bool is_closed = false;                    // bounds a body: fluid only where the normals point to; else on both sides
  std::vector<Point> position;               // (n_corners) [m]
  std::vector<Point> velocity;               // (n_corners) [m/s]
  std::vector<std::array<int, 3>> triangle;  // corners; the right-hand normal points to the side that is called outer
  /// Share of the fluid that passes through the surface as if it were not there, 0 to 1; empty: 0 everywhere. Rises
  /// across a smooth free edge, where the triangles go on beyond the sheet.
  std::vector<double> opening;  // (n_corners)
};

}  // namespace couplet::flow
