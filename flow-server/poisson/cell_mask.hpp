#pragma once
// A set of cells of a block, one bit a cell.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "flow-server/grid/box.hpp"

namespace couplet::flow {

/// Cells are added in any order and visited in that of memory.
class CellMask {
 public:
  CellMask() = default;
  /// Empty; cells outside the box are never taken.
  explicit CellMask(const Box& box)
      : box_(box),
        words_of_row_(box.is_empty() ? 0 : (static_cast<std::size_t>(box.size(0)) + 63) / 64),
        words_(box.is_empty()
                   ? 0
                   : words_of_row_ * static_cast<std::size_t>(box.size(1)) * static_cast<std::size_t>(box.size(2))) {}

  const Box& box() const { return box_; }

  void add(const Triple& cell) {
    if (!box_.contains(cell)) return;
    const int at = cell[0] - box_.begin[0];
    words_[first_word(cell[1], cell[2]) + static_cast<std::size_t>(at / 64)] |= std::uint64_t{1} << (at % 64);
  }
  void add(const Box& given) {
    const Box cells = intersection(given, box_);
    for (int k = cells.begin[2]; k < cells.end[2]; ++k)
      for (int j = cells.begin[1]; j < cells.end[1]; ++j)
        for (int i = cells.begin[0]; i < cells.end[0]; ++i) add(Triple{i, j, k});
  }
  /// Both cells of the upper face of a cell.
  void add_beside_face(int direction, Triple cell) {
    add(cell);
    ++cell[direction];
    add(cell);
  }
  void clear() { std::fill(words_.begin(), words_.end(), 0); }

  /// Calls visit(cell), rows in rising order of (k, j).
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::size_t word = 0;
    for (int k = box_.begin[2]; k < box_.end[2]; ++k)
      for (int j = box_.begin[1]; j < box_.end[1]; ++j)
        for (std::size_t w = 0; w < words_of_row_; ++w, ++word)
          for (std::uint64_t bits = words_[word]; bits != 0; bits &= bits - 1)
            visit(Triple{box_.begin[0] + static_cast<int>(w) * 64 + std::countr_zero(bits), j, k});
  }
  std::size_t n_bytes() const { return words_.size() * sizeof(std::uint64_t); }

 private:
  std::size_t first_word(int j, int k) const {
    return words_of_row_ * (static_cast<std::size_t>(j - box_.begin[1]) +
                            static_cast<std::size_t>(k - box_.begin[2]) * static_cast<std::size_t>(box_.size(1)));
  }
  Box box_;
  std::size_t words_of_row_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace couplet::flow
