#pragma once
// Moves a field from one sharing of the cells among the ranks to another.

#include <mpi.h>

#include <array>
#include <cstddef>
#include <vector>

#include "flow-server/grid/box.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// One sharing of cells: which box each rank of the communicator holds, in indices of the whole; empty boxes for ranks
/// that hold nothing.
using RankBoxes = std::vector<Box>;

/// Sends each value from the rank that has it to all ranks that want it, one message a pair of ranks. The boxes that
/// hold values do not overlap; those that want them may, and may reach beyond the ends of a periodic direction by up to
/// its length: ghost layers arrive with the rest. What nobody has stays as it is.
class Redistribution {
 public:
  /// Collective knowledge: each rank gives the same boxes. The communicator must outlive this.
  Redistribution(MPI_Comm communicator, const RankBoxes& from, const RankBoxes& to, const Triple& n_cells,
                 const std::array<bool, 3>& is_periodic);

  /// Collective. The origins are the global indices of the cells (0, 0, 0) of both fields on this rank.
  template <class Number>
  void move(const Field<Number>& from, const Triple& from_origin, Field<Number>& to, const Triple& to_origin);

  const Traffic& traffic() const { return traffic_; }

 private:
  struct Message {
    int rank;
    std::vector<Box> boxes;  // in indices of this rank's side
    std::vector<std::byte> values;
    std::size_t n_values() const;
  };
  MPI_Comm communicator_;
  int rank_;
  std::vector<Message> outgoing_, incoming_;
  std::vector<MPI_Request> requests_;
  Traffic traffic_;
};

}  // namespace couplet::flow
