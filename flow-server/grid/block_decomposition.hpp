#pragma once
// Which process owns which cells.

#include <mpi.h>

#include <array>
#include <vector>

#include "flow-server/grid/box.hpp"

namespace couplet::flow {

/// One direction cut into consecutive parts: part p holds the cells start[p] <= i < start[p + 1].
struct Partition {
  std::vector<int> start;

  int n_parts() const { return static_cast<int>(start.size()) - 1; }
  int n_cells() const { return start.back(); }
  int smallest_part() const;
  int part_of(int cell) const;
};

/// Parts of nearly equal size whose borders are multiples of `alignment` (but for the end).
Partition equal_parts(int n_cells, int n_parts, int alignment);

/// A block must be at least that wide in every direction that is cut: ghost layers come from direct neighbours only.
inline constexpr int smallest_block = 4;

/// How many parts each direction gets so that each rank has about the same number of cells and the least surface.
/// Throws SceneError when `n_ranks` leaves fewer than `smallest_block` cells in a direction, whatever the shape.
Triple choose_shape(const Triple& n_cells, int n_ranks);

/// Ranks are numbered with the part along x running fastest. Ranks beyond the product of the parts own nothing.
class BlockDecomposition {
 public:
  /// The communicator stays the caller's and must outlive this. Throws SceneError when a part is too small.
  BlockDecomposition(MPI_Comm communicator, std::array<Partition, 3> partitions, std::array<bool, 3> is_periodic);

  MPI_Comm communicator() const { return communicator_; }
  int rank() const { return rank_; }
  int n_ranks() const { return n_ranks_; }  // of the communicator
  Triple shape() const;                     // number of parts in each direction
  const std::array<Partition, 3>& partitions() const { return partitions_; }
  const std::array<bool, 3>& is_periodic() const { return is_periodic_; }

  Box all() const;            // all cells
  Box owned(int rank) const;  // in indices of the whole; empty for ranks without cells
  const Box& mine() const { return mine_; }
  bool has_cells() const { return !mine_.is_empty(); }

  /// Does my block end at the border of the whole (side 0: start, 1: end)? Never in a periodic direction.
  bool is_at_border(int direction, int side) const;
  /// The owner of the block `offset` (-1, 0 or 1 in each direction) away; MPI_PROC_NULL beyond a border.
  int neighbour(const Triple& offset) const;

 private:
  MPI_Comm communicator_;
  std::array<Partition, 3> partitions_;
  std::array<bool, 3> is_periodic_;
  int rank_ = 0, n_ranks_ = 1;
  Triple place_{0, 0, 0};  // of my part in each direction
  Box mine_;
};

}  // namespace couplet::flow
