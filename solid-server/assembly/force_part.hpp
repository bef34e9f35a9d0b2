#pragma once
// A part of the force on a node, in a buffer to which elements, faces and loads write, each to its own place.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct ForcePart {
  Index node = 0, start = 0;  // x, y, z, 0 from buffer[start] on, counted in doubles
};

}  // namespace couplet::solid
