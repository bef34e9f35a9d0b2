#pragma once
// A block of n_x times n_y times n_z hexahedra, whatever its shape.

#include <array>
#include <functional>

#include "solid-server/mesh/hex20_topology.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// A place in the lattice of half elements: corner nodes have even indices, midside nodes one odd index.
struct HalfIndex {
  int i = 0, j = 0, k = 0;
};

class StructuredBlock {
 public:
  StructuredBlock(int n_x, int n_y, int n_z);

  /// Nodes and elements; element and node numbers grow with x fastest and z slowest.
  SolidMesh mesh(const std::function<Eigen::Vector3d(const HalfIndex&)>& position) const;

  /// The element faces on one side of the block.
  std::vector<ElementFace> side(hex20::Side side) const;

  /// The node at a place of the lattice, or -1 when the serendipity element has none there (two odd indices or more).
  Index node_at(const HalfIndex& place) const;

 private:
  Index element_at(int i, int j, int k) const;
  std::size_t place_number(const HalfIndex& place) const;

  std::array<int, 3> n_;     // elements in each direction
  std::vector<Index> node_;  // of each place of the lattice
  Index n_nodes_ = 0;
};

}  // namespace couplet::solid
