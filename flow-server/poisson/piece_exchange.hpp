#pragma once
// Values of single unknowns from the ranks that own their cells.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// What all ranks call an unknown alike.
struct UnknownName {
  std::int64_t cell = 0;  // number of the cell in the whole grid, i running fastest
  int number = 0;         // 0: the cell's own place in the fields; from 1 on its further pieces
  friend auto operator<=>(const UnknownName&, const UnknownName&) = default;
};

/// The name of an unknown in a cell given by an index of the whole that may lie beyond the ends of periodic directions.
UnknownName name_of(Triple cell, int number, const Triple& n_cells);

/// An unknown and where its value stands in an array of this rank.
struct NamedPlace {
  UnknownName name;
  int place = 0;
};

/// Sends the value of each unknown from the rank that owns its cell to all that want it.
class PieceExchange {
 public:
  /// Collective. `owners`: which block owns a cell, blocks being numbered as ranks are, x fastest. `held`: at least
  /// what others want of the cells of this rank. The communicator must outlive this.
  PieceExchange(MPI_Comm communicator, const std::array<Partition, 3>& owners, std::vector<NamedPlace> held,
                const std::vector<NamedPlace>& wanted);

  /// Collective. From the places of what is held to the places of what is wanted; what nobody holds becomes 0. `from`
  /// and `to` may be the same array.
  template <class Number>
  void move(const Number* from, Number* to);

  const Traffic& traffic() const { return traffic_; }

 private:
  struct Message {
    int rank;
    std::vector<int> places;  // -1: not held
    std::vector<std::byte> values;
  };
  MPI_Comm communicator_;
  int rank_;
  std::vector<Message> outgoing_, incoming_;
  std::vector<MPI_Request> requests_;
  Traffic traffic_;
};

}  // namespace couplet::flow
