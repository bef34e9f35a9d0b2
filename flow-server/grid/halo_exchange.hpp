#pragma once
// Ghost layers from neighbours.

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// Fills the outermost `depth` ghost layers that other blocks own (edges and corners too) from their owners; periodic
/// directions wrap. Ghosts beyond a border of the whole are the caller's; beside a border they travel along with the
/// cells, so that neighbours agree on them. One message to each rank beside mine, whatever the number of fields. An
/// exchange between start and finish is under way while the caller works on what needs no ghosts; only one is under way
/// at a time.
class HaloExchange {
 public:
  explicit HaloExchange(const BlockDecomposition& decomposition);

  /// depth at most 4, in each of the fields at least that many ghosts in every direction that has ghosts.
  template <class Number>
  void start(const std::vector<Field<Number>*>& fields, int depth);
  template <class Number>
  void finish(const std::vector<Field<Number>*>& fields);
  template <class Number>
  void exchange(const std::vector<Field<Number>*>& fields, int depth) {
    start(fields, depth);
    finish(fields);
  }

  const Traffic& traffic() const { return traffic_; }

 private:
  /// A rank that owns blocks beside mine: one or, across a periodic direction with few blocks, several at once. What it
  /// sees at -offset is what I see at offset: it packs in rising, I unpack in falling order.
  struct Neighbour {
    int rank;
    std::vector<Triple> offsets;  // in rising order
    std::vector<std::byte> outgoing, incoming;
  };
  Box sent_box(const Triple& offset, const Triple& sizes, const Triple& depth) const;
  Box received_box(const Triple& offset, const Triple& sizes, const Triple& depth) const;

  MPI_Comm communicator_;
  int rank_;
  std::array<std::array<bool, 2>, 3> is_at_border_;
  std::vector<Neighbour> neighbours_;
  std::vector<MPI_Request> requests_;
  int depth_ = 0;
  Traffic traffic_;
};

}  // namespace couplet::flow
