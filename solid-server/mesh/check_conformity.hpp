#pragma once
// Elements of several shapes that meet: whether they share what lies between them.

#include <optional>
#include <string>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// What is wrong where two elements meet that do not share the middle of an edge (a midside node of one hangs free
/// beside the straight edge of another), or where two triangles stand against a quadrilateral: such neighbours hold
/// together at their corners only. The first such place with both elements, and how many there are; nothing where all
/// agree. A mesh of one shape always does.
std::optional<std::string> find_nonconforming(const SolidMesh& mesh);

}  // namespace couplet::solid
