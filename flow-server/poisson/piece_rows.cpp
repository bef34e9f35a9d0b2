#include "flow-server/poisson/piece_rows.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace couplet::flow {

namespace {

/// -3 to 3: towards which side the other end lies, the same on all ranks; 0: in the same cell.
int side_of(const Triple& cell, const Triple& other) {
  for (int d = 0; d < 3; ++d)
    if (other[d] != cell[d]) return other[d] > cell[d] ? d + 1 : -d - 1;
  return 0;
}

}  // namespace

PieceRows::PieceRows(const SplitCells& split, const std::array<LevelAxis, 3>& axes, const Triple& origin,
                     const Box& range)
    : range_(range) {
  // Half a link: what it adds to the row of one of its ends. Rows of cells come first, then those of pieces; entries of
  // a row stand by the side of their other end, then by its place.
  struct Half {
    std::int64_t row;    // kind of row, number of its cell in the range
    std::int64_t entry;  // place of the piece, side and place of the other end
    std::int64_t link;   // which end of which link
    bool operator<(const Half& other) const {
      return std::tie(row, entry, link) < std::tie(other.row, other.entry, other.link);
    }
  };
  constexpr int bits_of_place = 29, bits_of_side = 3;
  const std::int64_t n_in_range = range.n_cells();
  std::vector<Half> halves;
  const auto add = [&](const PressureUnknown& from, const PressureUnknown& to, std::int64_t link) {
    const Triple at{from.cell[0] - range.begin[0], from.cell[1] - range.begin[1], from.cell[2] - range.begin[2]};
    const std::int64_t cell = at[0] + range.size(0) * (at[1] + static_cast<std::int64_t>(range.size(1)) * at[2]);
    const std::int64_t side = side_of(from.cell, to.cell) + 3;
    halves.push_back({cell + (from.piece < 0 ? 0 : n_in_range),
                      (((from.piece + std::int64_t{1}) << bits_of_side | side) << bits_of_place) + to.piece + 1, link});
  };
  halves.reserve(2 * split.links.size());
  for (std::size_t l = 0; l < split.links.size(); ++l) {
    const SplitCells::Link& link = split.links[l];
    const auto number = static_cast<std::int64_t>(l);
    if (range.contains(link.a.cell)) add(link.a, link.b, 2 * number);
    if (range.contains(link.b.cell)) add(link.b, link.a, 2 * number + 1);
  }
  std::sort(halves.begin(), halves.end());
  entries_.reserve(halves.size());
  const auto is_same_row = [](const Half& a, const Half& b) {
    constexpr int other_end = bits_of_place + bits_of_side;
    return a.row == b.row && a.entry >> other_end == b.entry >> other_end;
  };
  for (std::size_t h = 0; h < halves.size(); ++h) {
    const SplitCells::Link& link = split.links[static_cast<std::size_t>(halves[h].link / 2)];
    const bool is_from_a = halves[h].link % 2 == 0;
    const PressureUnknown& unknown = is_from_a ? link.a : link.b;
    std::vector<Row>& rows = unknown.piece < 0 ? cells_ : pieces_;
    if (h == 0 || !is_same_row(halves[h - 1], halves[h])) {
      double volume = 1;
      for (int d = 0; d < 3; ++d) {
        const int n = axes[d].n_cells();
        volume *= axes[d].width[((origin[d] + unknown.cell[d]) % n + n) % n];
      }
      rows.push_back({unknown, volume, 0, h, h});
    }
    Row& row = rows.back();
    entries_.push_back({is_from_a ? link.b : link.a, link.conductance / row.volume});
    row.sum += entries_.back().coefficient;
    ++row.last;
  }
  std::size_t c = 0;
  for (int k = range.begin[2]; k < range.end[2]; ++k)
    for (int j = range.begin[1]; j < range.end[1]; ++j) {
      first_.push_back(c);
      while (c < cells_.size() && cells_[c].unknown.cell[1] == j && cells_[c].unknown.cell[2] == k) ++c;
    }
  first_.push_back(c);
}

std::span<const PieceRows::Row> PieceRows::cells(int j, int k) const {
  if (cells_.empty() || j < range_.begin[1] || j >= range_.end[1] || k < range_.begin[2] || k >= range_.end[2])
    return {};
  const auto row = static_cast<std::size_t>(j - range_.begin[1] + (k - range_.begin[2]) * range_.size(1));
  return {cells_.data() + first_[row], cells_.data() + first_[row + 1]};
}

}  // namespace couplet::flow
