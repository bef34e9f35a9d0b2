#pragma once
// How much the elements of a body have been stretched, compressed or sheared between two deformed states.

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// Watches the lengths between corners of elements: their edges, and the space diagonals of hexahedra, which shear
/// changes in the first order where it leaves edges alone.
class LengthChange {
 public:
  explicit LengthChange(const SolidMesh& mesh);

  /// The largest of l/l0 - 1 and l0/l - 1 over the elements of one member of a team: l at `displacement`, l0 at
  /// `before` (both (n_nodes, 4) [m]). The largest of all members does not depend on their number.
  double largest(const NodeVectors& before, const NodeVectors& displacement, int member, int n_members) const;

  std::size_t memory_bytes() const;

 private:
  struct Block {
    int n_corners = 0;
    std::vector<std::array<int, 2>> length;  // between two corners
    std::vector<Index> node_start;  // first entry of each corner in a NodeVectors array, (n_packs, n_corners, 8)
  };

  NodeVectors position_;  // at rest (n_nodes, 4) [m]
  std::vector<Block> blocks_;
};

}  // namespace couplet::solid
