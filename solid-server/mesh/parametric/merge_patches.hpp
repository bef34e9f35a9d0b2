#pragma once
// Structured blocks that touch, as one mesh.

#include <string>
#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// One mesh of patches whose common faces have their nodes at the same places (within coincidence_tolerance): nodes of
/// one place become one. Blocks of one region and shape become one block, in the order in which the regions first
/// appear; surfaces, node sets and markers of one name are joined.
SolidMesh merge_patches(const std::vector<SolidMesh>& patches);

}  // namespace couplet::solid
