#include "flow-server/grid/block_decomposition.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

std::string shape_text(const Triple& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

bool fits(const Triple& n_cells, const Triple& shape) {
  for (int d = 0; d < 3; ++d)
    if (shape[d] > 1 && n_cells[d] / shape[d] < smallest_block) return false;
  return true;
}

/// Faces that a block of the middle shares with others, times cells a direction: what travels in each exchange.
double shared_faces(const Triple& n_cells, const Triple& shape) {
  double faces = 0;
  for (int d = 0; d < 3; ++d) {
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    const double area = static_cast<double>(n_cells[a]) / shape[a] * n_cells[b] / shape[b];
    if (shape[d] > 1) faces += area * (shape[d] == 2 ? 1 : 2);
  }
  // Of two shapes with equal surface the one that cuts rows of memory less is better.
  return faces * (1 + 1e-3 * (shape[0] > 1) + 1e-4 * (shape[1] > 1));
}

}  // namespace

int Partition::smallest_part() const {
  int smallest = std::numeric_limits<int>::max();
  for (int p = 0; p < n_parts(); ++p) smallest = std::min(smallest, start[p + 1] - start[p]);
  return smallest;
}

int Partition::part_of(int cell) const {
  return static_cast<int>(std::upper_bound(start.begin(), start.end(), cell) - start.begin()) - 1;
}

Partition equal_parts(int n_cells, int n_parts, int alignment) {
  Partition partition;
  for (int p = 0; p <= n_parts; ++p) {
    const int exact = static_cast<int>(static_cast<std::int64_t>(n_cells) * p / n_parts);
    const int aligned = (exact + alignment / 2) / alignment * alignment;
    partition.start.push_back(p == n_parts ? n_cells : aligned);
  }
  // Where rounding makes a part too small the borders stand where equal sharing puts them.
  if (n_parts > 1 && alignment > 1 && partition.smallest_part() < std::min(smallest_block, n_cells / n_parts))
    return equal_parts(n_cells, n_parts, alignment / 2);
  return partition;
}

Triple choose_shape(const Triple& n_cells, int n_ranks) {
  Triple best{0, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (int x = 1; x <= n_ranks; ++x) {
    if (n_ranks % x != 0) continue;
    for (int y = 1; y <= n_ranks / x; ++y) {
      if (n_ranks / x % y != 0) continue;
      const Triple shape{x, y, n_ranks / x / y};
      if (!fits(n_cells, shape) || shared_faces(n_cells, shape) >= least) continue;
      best = shape;
      least = shared_faces(n_cells, shape);
    }
  }
  if (best[0] == 0) {
    throw report::SceneError("ranks",
                             std::to_string(n_ranks) + " ranks cannot share " + shape_text(n_cells) +
                                 " cells so that each has at least " + std::to_string(smallest_block) +
                                 " in every direction that is cut",
                             "use fewer ranks, or a number with other divisors");
  }
  return best;
}

BlockDecomposition::BlockDecomposition(MPI_Comm communicator, std::array<Partition, 3> partitions,
                                       std::array<bool, 3> is_periodic)
    : communicator_(communicator), partitions_(std::move(partitions)), is_periodic_(is_periodic) {
  MPI_Comm_rank(communicator_, &rank_);
  MPI_Comm_size(communicator_, &n_ranks_);
  const Triple parts = shape();
  if (parts[0] * parts[1] * parts[2] > n_ranks_) {
    throw report::SceneError(
        "ranks", "blocks " + shape_text(parts) + " need more than the " + std::to_string(n_ranks_) + " ranks there are",
        "start the flow with more ranks, or give fewer blocks");
  }
  for (int d = 0; d < 3; ++d) {
    if (parts[d] > 1 && partitions_[d].smallest_part() < smallest_block) {
      throw report::SceneError("ranks",
                               "a block has only " + std::to_string(partitions_[d].smallest_part()) +
                                   " cells in direction " + std::string(1, "xyz"[d]) + "; at least " +
                                   std::to_string(smallest_block) + " are needed",
                               "use fewer ranks in this direction");
    }
  }
  place_ = {rank_ % parts[0], rank_ / parts[0] % parts[1], rank_ / parts[0] / parts[1]};
  mine_ = owned(rank_);
}

Triple BlockDecomposition::shape() const {
  return {partitions_[0].n_parts(), partitions_[1].n_parts(), partitions_[2].n_parts()};
}

Box BlockDecomposition::all() const {
  return box_of({partitions_[0].n_cells(), partitions_[1].n_cells(), partitions_[2].n_cells()});
}

Box BlockDecomposition::owned(int rank) const {
  const Triple parts = shape();
  if (rank >= parts[0] * parts[1] * parts[2]) return {};
  const Triple place{rank % parts[0], rank / parts[0] % parts[1], rank / parts[0] / parts[1]};
  Box box;
  for (int d = 0; d < 3; ++d) {
    box.begin[d] = partitions_[d].start[place[d]];
    box.end[d] = partitions_[d].start[place[d] + 1];
  }
  return box;
}

bool BlockDecomposition::is_at_border(int direction, int side) const {
  if (is_periodic_[direction] || !has_cells()) return false;
  return side == 0 ? mine_.begin[direction] == 0 : mine_.end[direction] == partitions_[direction].n_cells();
}

int BlockDecomposition::neighbour(const Triple& offset) const {
  if (!has_cells()) return MPI_PROC_NULL;
  const Triple parts = shape();
  Triple place = place_;
  for (int d = 0; d < 3; ++d) {
    place[d] += offset[d];
    if (place[d] >= 0 && place[d] < parts[d]) continue;
    if (!is_periodic_[d]) return MPI_PROC_NULL;
    place[d] = (place[d] + parts[d]) % parts[d];
  }
  return place[0] + parts[0] * (place[1] + parts[1] * place[2]);
}

}  // namespace couplet::flow
