#pragma once
// What the links of split cells add to the rows of div grad on one block.

#include <span>
#include <vector>

#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// The rows of further pieces, and the parts of the rows of the cells' own unknowns that come from links.
class PieceRows {
 public:
  struct Entry {
    PressureUnknown other;
    double coefficient;  // conductance over the volume of the row's cell [1/m^2]
  };
  /// Sum of coefficient (other - unknown) over its entries.
  struct Row {
    PressureUnknown unknown;
    double volume;  // of the cell [m^3]
    double sum;     // of its coefficients [1/m^2]
    std::size_t first, last;
  };

  PieceRows() = default;
  /// Rows of unknowns in the local box `range`. `origin`: the cell (0, 0, 0) in indices of the whole.
  PieceRows(const SplitCells& split, const std::array<LevelAxis, 3>& axes, const Triple& origin, const Box& range);

  bool is_empty() const { return cells_.empty() && pieces_.empty(); }
  /// In rising order of (k, j, i), pieces of one cell by their place in the list; entries in an order that is the same
  /// on all ranks.
  std::span<const Row> pieces() const { return pieces_; }
  std::span<const Row> cells() const { return cells_; }
  std::span<const Row> cells(int j, int k) const;  // those of one row of cells
  std::size_t n_bytes() const {
    return (pieces_.size() + cells_.size()) * sizeof(Row) + entries_.size() * sizeof(Entry);
  }
  std::span<const Entry> entries(const Row& row) const {
    return {entries_.data() + row.first, entries_.data() + row.last};
  }
  /// Sum of coefficient (other - unknown).
  template <class Number>
  double applied(const Row& row, const Field<Number>& cells, std::span<const Number> pieces) const {
    const double own = value(row.unknown, cells, pieces);
    double sum = 0;
    for (const Entry& entry : entries(row)) sum += entry.coefficient * (value(entry.other, cells, pieces) - own);
    return sum;
  }
  template <class Number>
  static double value(const PressureUnknown& unknown, const Field<Number>& cells, std::span<const Number> pieces) {
    if (unknown.piece >= 0) return static_cast<double>(pieces[static_cast<std::size_t>(unknown.piece)]);
    return static_cast<double>(cells(unknown.cell[0], unknown.cell[1], unknown.cell[2]));
  }

 private:
  Box range_;
  std::vector<Row> pieces_, cells_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> first_;  // (n_rows of cells in the range + 1) into cells_
};

}  // namespace couplet::flow
