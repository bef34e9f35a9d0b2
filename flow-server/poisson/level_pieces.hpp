#pragma once
// The further pieces of split cells on one level of the multigrid.

#include <span>
#include <vector>

#include "flow-server/grid/field.hpp"
#include "flow-server/poisson/piece_exchange.hpp"
#include "flow-server/poisson/piece_rows.hpp"
#include "flow-server/poisson/split_links.hpp"

namespace couplet::flow {

/// Pieces of the cells of one block and of the ghosts around it, in rising order of their cells. They are smoothed in a
/// list, with what else is unknown in their cell, cells coloured red and black; while the cells are smoothed they stand
/// still and give to the right-hand side.
class LevelPieces {
 public:
  /// Collective. `links`: with an end in the local box `range`, in which rows are wanted.
  LevelPieces(const std::vector<GridLink>& links, const std::array<LevelAxis, 3>& axes,
              const BlockDecomposition& decomposition, const Box& range);

  const PieceRows& rows() const { return rows_; }
  const std::vector<NamedPlace>& names() const { return names_; }          // of all pieces in the list
  const std::vector<NamedPlace>& own_names() const { return own_names_; }  // of those of this rank
  const Triple& cell_of(int piece) const { return cell_[static_cast<std::size_t>(piece)]; }
  int n_pieces() const { return static_cast<int>(names_.size()); }

  bool is_linked(const Triple& cell) const;   // has the cell's own unknown a link?
  double link_sum(const Triple& cell) const;  // of the coefficients of its links [1/m^2]

  std::vector<float> phi, rhs;  // (n_pieces)

  /// Ghosts of phi from their owners.
  void exchange(std::vector<float>& values) { to_ghosts_.move(values.data(), values.data()); }

  /// One Gauss-Seidel step from phi = 0 with 0 in the cells; then ghosts are exchanged. Needs rhs in one ghost layer.
  void relax_from_zero();
  /// One Gauss-Seidel step on the pieces of the block, with the cell itself where it is linked to one of its pieces.
  /// Needs phi of cells and pieces in two ghost layers, rhs in one. Ghosts are left as they were, or worse.
  void relax(const FaceFractions& share, const Field<float>& cell_rhs, Field<float>& cell_phi);
  /// What pieces give to the rows of cells goes into the right-hand side, and out again.
  void take_from(Field<float>& cell_rhs);
  void restore(Field<float>& cell_rhs) const;
  /// rhs - A phi, of the pieces of this rank.
  void residual(const Field<float>& cell_phi, std::vector<float>& residual) const;

  std::size_t n_bytes() const;
  const Traffic& traffic() const { return to_ghosts_.traffic(); }

 private:
  /// The pieces of one cell, and its own unknown where that is linked to one of them.
  struct PiecesOfCell {
    std::span<const PieceRows::Row> rows;
    const PieceRows::Row* own;  // none: not linked
    int colour;                 // 0 or 1
  };
  /// Of the cells; none: all are 0 and stay so.
  struct CellValues {
    const FaceFractions& share;
    const Field<float>& rhs;
    Field<float>& phi;
  };
  void find_cells();
  void relax_colour(int colour, const Box& cells, const CellValues* values);
  template <int most>
  void relax_block(std::span<const PieceRows::Row> rows, const PieceRows::Row* own, const CellValues* values);

  LevelPieces(const LocalSplit& local, const std::array<LevelAxis, 3>& axes, const BlockDecomposition& decomposition,
              const Box& range);

  const std::array<LevelAxis, 3>& axes_;
  Triple origin_;
  Box mine_;                  // local
  std::vector<Triple> cell_;  // (n_pieces)
  std::vector<NamedPlace> names_, own_names_;
  PieceRows rows_;
  std::vector<PiecesOfCell> pieces_of_cell_;
  PieceExchange to_ghosts_;
  std::vector<float> kept_rhs_;  // (n_cells with links)
};

}  // namespace couplet::flow
