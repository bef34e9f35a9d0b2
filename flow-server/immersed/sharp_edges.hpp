#pragma once
// Where a closed surface is not smooth.

#include <array>
#include <span>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow {

/// A side of two triangles whose normals differ by more than 45 degrees.
struct SharpEdge {
  int triangle;            // one of the two
  std::array<int, 2> end;  // corners of that triangle: 0 to 2
  bool is_convex;          // turns away from the outer side
};

/// Of some triangles, given by their corners; sides of one triangle only are none.
std::vector<SharpEdge> find_sharp_edges(std::span<const Point> position, std::span<const std::array<int, 3>> triangle);

}  // namespace couplet::flow
