#pragma once
// Nodes that belong to one region each, for fields that jump where two materials meet.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Where regions meet, a node has a copy for each of them but the first one.
struct RegionNodes {
  std::vector<Index> origin;              // node of the mesh, of each; the nodes of the mesh come first
  std::vector<std::vector<Index>> block;  // of each block: (n_elements, nodes of the shape), like ElementBlock::node

  Index n_nodes() const { return static_cast<Index>(origin.size()); }
};

/// The region of each block, counted from 0 in the order in which they come; blocks of one name in one body are one
/// region.
std::vector<int> region_numbers(const SolidMesh& mesh);

RegionNodes nodes_by_region(const SolidMesh& mesh);
/// The nodes of the mesh as they are.
RegionNodes shared_nodes(const SolidMesh& mesh);

}  // namespace couplet::solid
