#pragma once
// A block of cells: half-open ranges of indices in three directions.

#include <algorithm>
#include <array>
#include <cstdint>

namespace couplet::flow {

using Triple = std::array<int, 3>;

struct Box {
  Triple begin{0, 0, 0};
  Triple end{0, 0, 0};

  int size(int direction) const { return end[direction] - begin[direction]; }
  Triple sizes() const { return {size(0), size(1), size(2)}; }
  bool is_empty() const { return size(0) <= 0 || size(1) <= 0 || size(2) <= 0; }
  std::int64_t n_cells() const { return is_empty() ? 0 : static_cast<std::int64_t>(size(0)) * size(1) * size(2); }
  bool contains(const Triple& cell) const {
    for (int d = 0; d < 3; ++d)
      if (cell[d] < begin[d] || cell[d] >= end[d]) return false;
    return true;
  }
  /// The box with every index moved by -origin: global indices become local ones.
  Box relative_to(const Triple& origin) const {
    Box moved = *this;
    for (int d = 0; d < 3; ++d) moved.begin[d] -= origin[d], moved.end[d] -= origin[d];
    return moved;
  }
  /// Grown by `layers` on both sides of each direction; negative layers shrink.
  Box grown(const Triple& layers) const {
    Box other = *this;
    for (int d = 0; d < 3; ++d) other.begin[d] -= layers[d], other.end[d] += layers[d];
    return other;
  }

  friend bool operator==(const Box&, const Box&) = default;
};

/// A box of that many cells that begins at the origin.
inline Box box_of(const Triple& sizes) {
  return {{0, 0, 0}, sizes};
}

inline Box intersection(const Box& a, const Box& b) {
  Box both;
  for (int d = 0; d < 3; ++d) {
    both.begin[d] = std::max(a.begin[d], b.begin[d]);
    both.end[d] = std::max(both.begin[d], std::min(a.end[d], b.end[d]));
  }
  return both;
}

}  // namespace couplet::flow
