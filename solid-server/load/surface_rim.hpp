#pragma once
// The edges where a surface ends.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// The nodes on edges that one face only has, rising, each once. Empty: the surface is closed.
std::vector<Index> nodes_of_rim(const std::vector<FaceNodes>& faces);

}  // namespace couplet::solid
