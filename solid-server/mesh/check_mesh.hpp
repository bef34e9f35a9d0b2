#pragma once
// Meshes that no body can be computed on.

#include <string>
#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Refuses a mesh with elements that are inverted or folded (det(dX/dxi) not above 0 at a corner or quadrature point),
/// whose midside nodes stand outside the middle half of their edges, that name a node twice or have the corners of
/// another element; with nodes that no element uses or that stand at the same place as another one; with elements of no
/// region beside named regions; with neighbours of different shapes that do not fit together; with surfaces whose faces
/// lie inside the body, belong to no element or stand there twice. Throws SceneError with one line for each complaint,
/// beginning with `where`, ten at most and the number of the others.
void check_mesh(const SolidMesh& mesh, const std::string& where);

/// The parts of a mesh: elements that hang together by nodes.
struct MeshParts {
  std::vector<Index> part_of_node;   // (n_nodes); -1: no element uses it
  std::vector<Index> first_element;  // of each part
};

MeshParts find_parts(const SolidMesh& mesh);

/// Refuses a mesh of several parts when one of them has none of the supported nodes. Throws SceneError naming `where`.
void check_connected(const SolidMesh& mesh, const std::vector<Index>& supported_nodes, const std::string& where);

}  // namespace couplet::solid
