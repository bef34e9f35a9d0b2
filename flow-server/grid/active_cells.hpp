#pragma once
// Which cells of a block hold fluid.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "flow-server/grid/box.hpp"

namespace couplet::flow {

/// Cells begin <= i < end of a row.
struct Interval {
  int begin = 0, end = 0;
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// For each row (j, k) of a block the intervals of active cells, in rising order. Everything that sweeps over cells
/// asks this, so that inactive cells take no time. Rows may lie in the ghost layers.
class ActiveCells {
 public:
  /// All cells of `range` (local indices, ghosts included as wanted).
  static ActiveCells all(const Box& range);
  /// `append(j, k, intervals)` appends the intervals of a row in rising order, within the range.
  static ActiveCells of_rows(const Box& range,
                             const std::function<void(int j, int k, std::vector<Interval>& intervals)>& append);
  static ActiveCells where(const Box& range, const std::function<bool(int i, int j, int k)>& is_active);

  const Box& range() const { return range_; }
  std::int64_t n_cells() const { return n_cells_; }
  bool is_full() const { return n_cells_ == range_.n_cells(); }
  std::span<const Interval> row(int j, int k) const {
    const std::size_t r = static_cast<std::size_t>(j - range_.begin[1]) +
                          static_cast<std::size_t>(k - range_.begin[2]) * static_cast<std::size_t>(range_.size(1));
    return {intervals_.data() + first_[r], intervals_.data() + first_[r + 1]};
  }
  bool contains(int i, int j, int k) const;

 private:
  explicit ActiveCells(const Box& range) : range_(range) {}
  Box range_;
  std::int64_t n_cells_ = 0;
  std::vector<Interval> intervals_;
  std::vector<std::size_t> first_{0};  // (n_rows + 1)
};

}  // namespace couplet::flow
