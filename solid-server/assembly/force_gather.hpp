#pragma once
// The force on a node is the sum of the parts that elements, faces and loads have written into one buffer. Each part
// has its own place and each node adds up its parts in a fixed order: the result has the same bits for any number of
// threads.

#include <vector>

#include "solid-server/element/lane_transpose.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// A part of a node's force: x, y, z, 0 at buffer[start].
struct ForcePart {
  Index node = 0, start = 0;
};

class ForceGather {
 public:
  /// Parts of a node are added in the order in which they stand in the list.
  ForceGather(Index n_nodes, const std::vector<ForcePart>& parts);

  [[gnu::always_inline]] NodeQuad sum(Index node, const double* buffer) const {
    NodeQuad total{};
    for (Index n = first_[static_cast<std::size_t>(node)]; n < first_[static_cast<std::size_t>(node) + 1]; ++n)
      total += load_quad(buffer + start_[static_cast<std::size_t>(n)]);
    return total;
  }

 private:
  std::vector<Index> first_, start_;
};

}  // namespace couplet::solid
