#pragma once
// Parts of a mesh that stand inside each other at rest.

#include <optional>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// A node that lies inside an element of another part.
struct Overlap {
  Index node = 0, element = 0;
};

/// The first node of `faces` that lies in an element of another part of the mesh (elements that hang together by
/// nodes), of a part that one of the `others` belongs to. Elements count as bounded by the mean planes of their
/// corners, and a node as inside when it is deeper below the surface than a tenth of the element's size (the cube root
/// of its volume): surfaces that just touch, or cross by the flatness of their faces, do not overlap.
std::optional<Overlap> find_overlap(const SolidMesh& mesh, const std::vector<ElementFace>& faces,
                                    const std::vector<ElementFace>& others);

}  // namespace couplet::solid
