#pragma once
// Which unknowns of the cells of one coarse cell are connected, while the aggregates of a level are chosen.

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "flow-server/grid/field.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/level_pieces.hpp"

namespace couplet::flow {

/// What the choice of aggregates needs to know of a fine level.
struct FineLevel {
  const std::array<LevelAxis, 3>& axes;
  const BlockDecomposition& decomposition;
  const FaceFractions* share;             // four filled ghost layers; none: whole borders
  const Field<float>* inverse_diagonal;   // where there are shares; 0: inactive
  const std::array<Merging, 3>& merging;  // of the whole
  const std::array<LevelAxis, 3>& coarse_axes;
  LevelPieces* pieces;  // none: no cell of the level is split
};

/// One level while its aggregates are chosen. Cells and faces in local indices, with ghosts.
class AggregateChoice {
 public:
  static constexpr int ghost_layers = 4;  // of cells of which all is known

  /// `code`: of each cell the number of its aggregate in its coarse cell, 0 for the one that has the coarse cell
  /// itself; cut() writes it. Both must outlive this.
  AggregateChoice(const FineLevel& fine, Field<float>& code);

  const Box& coarse_box() const { return coarse_box_; }  // the coarse cells over the block, in indices of the whole
  /// The coarse cell over a cell, counted from the first one over the block.
  Triple group_of(const Triple& cell) const {
    return {coarse_at(0, cell[0]), coarse_at(1, cell[1]), coarse_at(2, cell[2])};
  }
  bool is_beyond_border(const Triple& cell) const {
    return coarse_at(0, cell[0]) == outside || coarse_at(1, cell[1]) == outside || coarse_at(2, cell[2]) == outside;
  }
  double width_at(int d, int i) const { return width_[d][static_cast<std::size_t>(i + ghost_layers)]; }
  double volume(const Triple& cell) const { return width_at(0, cell[0]) * width_at(1, cell[1]) * width_at(2, cell[2]); }
  double coarse_width(int d, int C) const {
    const int n = fine_.coarse_axes[d].n_cells();
    return fine_.coarse_axes[d].width[((coarse_box_.begin[d] + C) % n + n) % n];
  }
  /// The number of the aggregate that an unknown belongs to.
  int code(const PressureUnknown& u) const {
    return static_cast<int>(u.piece < 0 ? cell_code_(u.cell[0], u.cell[1], u.cell[2]) : piece_code_[u.piece]);
  }
  /// Collective: the codes of neighbours.
  void exchange(HaloExchange& halo) {
    halo.exchange<float>({&cell_code_}, 1);
    if (fine_.pieces) fine_.pieces->exchange(piece_code_);
  }

  /// The aggregates of one coarse cell; appends its cells that do not belong to the coarse cell itself.
  void cut(const Triple& C, std::vector<Triple>& members);

  /// Calls visit(other, direction, side, share, area, conductance) for each neighbour, those beyond an open border too;
  /// share: of a full face of that area; direction -1: in the same cell.
  template <class Visit>
  void for_neighbours(const PressureUnknown& u, const Visit& visit) const {
    const Triple& c = u.cell;
    const PieceRows::Row* row = u.piece < 0 ? nullptr : piece_row_[u.piece];
    if (u.piece < 0)
      for (int d = 0; d < 3; ++d) {
        if (!fine_.axes[d].has_terms) continue;
        for (const int side : {-1, 1}) {
          PressureUnknown other{c, -1};
          other.cell[d] += side;
          const Triple& face = side < 0 ? other.cell : c;
          const double share = static_cast<double>((*fine_.share)[d](face[0], face[1], face[2]));
          if (share == 0) continue;
          const double area = volume(c) / width_at(d, c[d]);
          visit(other, d, side, share, area, share * area / distance(d, c[d], side));
        }
      }
    if (!fine_.pieces) return;
    if (u.piece < 0)
      for (const PieceRows::Row& one : fine_.pieces->rows().cells(c[1], c[2]))
        if (one.unknown.cell[0] == c[0]) row = &one;
    if (!row) return;
    for (const PieceRows::Entry& entry : fine_.pieces->rows().entries(*row)) {
      int direction = -1, side = 0;
      double length = std::numeric_limits<double>::infinity();  // of the cell along the link
      for (int d = 0; d < 3; ++d) {
        if (entry.other.cell == c && fine_.axes[d].has_terms) length = std::min(length, width_at(d, c[d]));
        if (entry.other.cell[d] != c[d]) direction = d, side = entry.other.cell[d] - c[d], length = width_at(d, c[d]);
      }
      const double conductance = entry.coefficient * row->volume, area = row->volume / length;
      const double apart = direction < 0 ? length : distance(direction, c[direction], side);
      visit(entry.other, direction, side, conductance * apart / area, area, conductance);
    }
  }
  /// Between the centres of a cell and the next one, or the border.
  double distance(int d, int i, int side) const { return 0.5 * (width_at(d, i) + width_at(d, i + side)); }

 private:
  static constexpr int outside = std::numeric_limits<int>::min();
  int coarse_at(int d, int i) const { return coarse_[d][static_cast<std::size_t>(i + ghost_layers)]; }
  std::size_t group_number(const Triple& C) const {
    return static_cast<std::size_t>(C[0] + coarse_box_.size(0) * (C[1] + coarse_box_.size(1) * C[2]));
  }
  bool has_weak_face(const Box& cells) const;
  /// Codes of the unknowns of one coarse cell, cells in rising order, then pieces.
  void number_parts(const std::vector<PressureUnknown>& all, bool has_pieces);

  const FineLevel& fine_;
  Box mine_, coarse_box_;  // in indices of the whole
  Field<float>& cell_code_;
  std::array<std::vector<int>, 3> coarse_;        // local coarse index of each cell from the first ghost on
  std::array<std::vector<double>, 3> width_;      // likewise; 0 beyond a border
  std::vector<float> piece_code_;                 // (n_pieces)
  std::vector<const PieceRows::Row*> piece_row_;  // (n_pieces) none: too far off
  struct Coupling {
    std::size_t a, b;
    double share;
  };
  /// Of those that become one coarse cell.
  struct Unknown {
    double most, sum;  // of its couplings, capped at a full face; of all
    double strongest;
    std::size_t closest;  // across the strongest coupling, where it is of the same coarse cell
    std::size_t root;     // of the tree of those that are connected
    int size, number;     // of what is connected, at its root
  };
  std::vector<Coupling> couplings_;
  std::vector<Unknown> unknowns_;
  struct PieceOfGroup {
    std::size_t group;
    PressureUnknown unknown;
  };
  std::vector<PieceOfGroup> pieces_;  // of this block, in rising order of groups
};

}  // namespace couplet::flow
