#pragma once
// In which order the elements of a body are computed and its nodes collect their forces, so that a force is still in
// the cache when it is collected.

#include <vector>

#include "solid-server/assembly/force_part.hpp"
#include "solid-server/element/element_packs.hpp"
#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

/// Each member of a team goes through its own chunks of packs in order. After a chunk it visits the nodes whose last
/// element was in it: every element around such a node has been computed, so its displacement may change at once. The
/// places of chunks whose nodes have all been visited are used again. Nodes between two members' elements are visited
/// at the end, when all members have arrived.
///
/// A node adds up its parts in an order that does not depend on the number of members: blocks and elements rising, then
/// the parts of faces and loads as they were given.
struct SweepPlan {
  struct Chunk {
    Index block = 0, first_pack = 0, last_pack = 0;
    Index place = 0;                        // of its forces in the buffer, in packs
    Index first_visit = 0, last_visit = 0;  // the nodes to visit after it
  };
  std::vector<Chunk> chunks;
  std::vector<Index> first_chunk;         // of each member, (n_members + 1)
  std::vector<Index> first_shared_visit;  // of each member, (n_members + 1)
  std::vector<Index> visit_node;          // (n_visits = n_nodes)
  std::vector<Index> first_part;          // (n_visits + 1)
  std::vector<Index> part_start;          // of each part in the buffer, in doubles
  std::size_t n_element_packs = 0;        // places for forces of elements; those of faces and loads follow

  /// The force on the node of a visit: x, y, z, 0.
  [[gnu::always_inline]] NodeQuad sum(Index visit, const double* buffer) const {
    NodeQuad total{};
    for (Index n = first_part[static_cast<std::size_t>(visit)]; n < first_part[static_cast<std::size_t>(visit) + 1];
         ++n)
      total += load_quad(buffer + part_start[static_cast<std::size_t>(n)]);
    return total;
  }
};

/// `external_parts` start after the places of the elements: their `start` is counted from there.
SweepPlan make_sweep_plan(const std::vector<const ElementPacks*>& blocks, Index n_nodes,
                          const std::vector<ForcePart>& external_parts, int n_members);

}  // namespace couplet::solid
