#pragma once
// The way from one level of the multigrid to the next coarser one and back, on the block of one rank.

#include <array>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/poisson/connected_aggregates.hpp"

namespace couplet::flow {

/// How the cells of this block are joined to coarse ones in one direction; coarse indices are local to the coarse block
/// that lies over this one.
struct BlockMerging {
  struct Run {
    int first_fine, first_coarse, n_coarse, group_size;
  };
  std::vector<Run> runs;       // of coarse cells that hold equally many fine ones
  std::vector<int> coarse;     // (n) of each fine cell
  std::vector<float> share;    // (n) width of the fine cell over that of the coarse one
  std::vector<int> neighbour;  // (n) the coarse cell on the other side of the fine centre
  std::vector<float> weight;   // (n) of that neighbour in linear interpolation between coarse centres
  int n_coarse = 0;
};

/// Residuals go down as volume-weighted means, corrections come up by linear interpolation. Where sheets cut cells,
/// unknowns that are not connected with the coarse cell over them take part in that of their aggregate.
class LevelTransfer {
 public:
  /// What `fine` refers to must outlive this.
  explicit LevelTransfer(const FineLevel& fine);

  /// Collective, where there are shares; see ConnectedAggregates::update. `pieces`: those of the level now.
  void update(LevelPieces* pieces, const CellMask& changed, HaloExchange& halo);

  Box coarse_box() const { return coarse_box_; }  // global indices of the coarse cells over this block

  /// Adds one row of residuals to the coarse right-hand side, which the first row of a coarse cell sets to 0. What does
  /// not go to the coarse cells over the row is kept and becomes 0 in the row. None: nothing is active in the row.
  void restrict_row(int j, int k, float* residual, Field<float>& coarse_rhs);
  /// After all rows: what was kept, and the residuals of the pieces of this level (n_pieces), go where they belong;
  /// those of coarse pieces to coarse_pieces_rhs.
  void finish_restriction(const std::vector<float>& piece_residual, Field<float>& coarse_rhs);
  /// Adds the interpolated correction; needs one filled ghost layer of it, and coarse_pieces_phi.
  void add_correction(const Field<float>& coarse_phi, const FaceFractions* coarse_share, const ActiveCells& active,
                      Field<float>& phi);

  /// phi of each unknown becomes that of its coarse one; where that is 0, for it belongs to nothing on the coarse
  /// level, the number of its aggregate among those of this block, counted down from -2. Returns how many there are.
  int inject(const Field<float>& coarse_phi, const ActiveCells& active, Field<float>& phi) const;

  /// Does an unknown belong to nothing on the coarse level? Asked after update(), of the coarse cells that it touched
  /// and of all pieces; `is_active(C)`: is the coarse cell with that local index, `linked`: 0 for pieces that are not.
  template <class IsActive>
  bool has_part_alone(const IsActive& is_active, std::span<const float> linked) const;

  /// Calls set(direction, cell before the face, share) for the faces of the coarse cells that update() touched, local
  /// indices of the coarse block: area-weighted means. Those at the start of the block included, at a border.
  template <class Set>
  void coarse_shares(const Set& set) const;

  std::size_t n_bytes() const { return aggregates_ ? aggregates_->n_bytes() : 0; }

  /// Where there are shares.
  const ConnectedAggregates& aggregates() const { return *aggregates_; }
  std::vector<float> coarse_pieces_rhs, coarse_pieces_phi;  // of the coarse cells over this block

 private:
  float coarse_share(int d, const Triple& C, bool is_first) const;
  Box cells_of(const Triple& C) const;  // fine, local
  float correction_of(const ConnectedAggregates::Member& member, const Field<float>& coarse_phi) const;

  FineLevel fine_;
  Triple sizes_;
  std::array<BlockMerging, 3> merging_;
  Box coarse_box_;
  std::unique_ptr<ConnectedAggregates> aggregates_;  // where there are shares
  std::vector<float> kept_;                          // residuals of its members
  std::vector<float> base_row_, slope_row_, correction_row_;
};

template <class Set>
void LevelTransfer::coarse_shares(const Set& set) const {
  if (!fine_.decomposition.has_cells()) return;
  const auto terms = aggregates_->share_terms();
  const auto order = [](const Triple& cell, int d) { return std::tuple(cell[2], cell[1], cell[0], d); };
  auto next = terms.begin();
  const auto add_term = [&](int d, const Triple& C, float share) {
    // Both run in rising order, but for the faces at the start.
    while (next != terms.end() && order(next->coarse, next->direction) < order(C, d)) ++next;
    const bool is_found = next != terms.end() && next->coarse == C && next->direction == d;
    return is_found ? static_cast<float>(static_cast<double>(share) + next->share) : share;
  };
  CellMask cells(box_of(coarse_box_.sizes()));
  aggregates_->touched().for_each([&](const Triple& C) {
    cells.add(C);
    for (int d = 0; d < 3; ++d) {
      Triple before = C;
      --before[d];
      cells.add(before);
    }
  });
  cells.for_each([&](const Triple& C) {
    for (int d = 0; d < 3; ++d)
      if (fine_.axes[d].has_terms) set(d, C, add_term(d, C, coarse_share(d, C, false)));
  });
  for (int d = 0; d < 3; ++d) {
    if (!fine_.axes[d].has_terms || !fine_.decomposition.is_at_border(d, 0)) continue;
    next = terms.begin();
    cells.for_each([&](const Triple& C) {
      if (C[d] != 0) return;
      Triple before = C;
      --before[d];
      set(d, before, add_term(d, before, coarse_share(d, C, true)));
    });
  }
}

template <class IsActive>
bool LevelTransfer::has_part_alone(const IsActive& is_active, std::span<const float> linked) const {
  for (const ConnectedAggregates::Member& member : aggregates_->members())
    if (member.piece >= 0 ? linked[static_cast<std::size_t>(member.piece)] == 0 : !is_active(member.coarse))
      return true;
  bool is_any = false;
  aggregates_->touched().for_each([&](const Triple& C) {
    if (is_any || is_active(C)) return;
    const Box cells = cells_of(C);
    for (int k = cells.begin[2]; k < cells.end[2]; ++k)
      for (int j = cells.begin[1]; j < cells.end[1]; ++j)
        for (int i = cells.begin[0]; i < cells.end[0]; ++i)
          is_any = is_any || ((*fine_.inverse_diagonal)(i, j, k) != 0 && aggregates_->is_regular(i, j, k));
  });
  return is_any;
}

}  // namespace couplet::flow
