#pragma once
// What a mesh file gives.

#include <string>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct MeshReading {
  SolidMesh mesh;
  std::string note;  // for the user: what the file says beyond a mesh; empty: nothing
};

}  // namespace couplet::solid
