#pragma once
// Which unknowns of a level are merged into one of the next coarser level where sheets cut the cells.

#include <span>
#include <vector>

#include "flow-server/poisson/aggregate_choice.hpp"
#include "flow-server/poisson/cell_mask.hpp"

namespace couplet::flow {

/// The unknowns of the cells that become one coarse cell form as many aggregates as they have connected parts: so the
/// two sides of a sheet never mix, and neither do two gaps between sheets. The largest part has the coarse cell, the
/// others are further pieces of it. What is connected on one level is connected on the next, and nothing else.
class ConnectedAggregates {
 public:
  /// An unknown that does not simply belong to the coarse cell over it: a cell of a smaller part, or a piece.
  struct Member {
    PressureUnknown unknown;
    Triple coarse;       // local index of the coarse cell over it
    int piece;           // which further piece of the coarse cells over this block; -1: the coarse cell itself
    float volume_share;  // volume of the fine cell over that of the coarse one
  };

  explicit ConnectedAggregates(const FineLevel& fine);

  /// Collective. Shares, diagonals or links have changed at most at the given cells of the block, and at faces of the
  /// block. What depends on them is made anew, and all that is said of pieces, as their numbers may have changed.
  void update(const FineLevel& fine, const CellMask& changed, HaloExchange& halo);
  /// Coarse cells, local indices, whose aggregates or the shares of whose faces may have changed in update().
  const CellMask& touched() const { return touched_; }

  std::span<const Member> cells(int j, int k) const;            // of one row of cells, in rising order
  std::span<const Member> members() const { return members_; }  // cells in rising order, then pieces
  std::size_t n_cells() const { return n_cells_; }              // that many are cells
  bool is_regular(int i, int j, int k) const { return code_(i, j, k) == 0; }

  /// Pieces of the coarse cells over this block; those without a link are parts of the fluid by themselves.
  const std::vector<NamedPlace>& coarse_pieces() const { return coarse_pieces_; }
  const std::vector<GridLink>& coarse_links() const { return coarse_links_; }  // each on the rank of its lower end
  /// Shares of coarse faces that come from members, to be added to those of the other fine faces; in rising order of
  /// (k, j, i, direction).
  struct ShareTerm {
    int direction;
    Triple coarse;  // local index of the cell before the face
    double share;
  };
  std::span<const ShareTerm> share_terms() const { return share_terms_; }

  std::size_t n_bytes() const;

 private:
  void find_members(const FineLevel& fine, const AggregateChoice& choice, std::vector<Triple> cells);
  void find_links(const FineLevel& fine, const AggregateChoice& choice);

  Triple sizes_;
  CellMask touched_;
  Field<float> code_;  // of a cell: the number of its aggregate in the coarse cell
  std::vector<Member> members_;
  std::size_t n_cells_ = 0;
  std::vector<std::size_t> first_;  // (ny * nz + 1) into members_
  std::vector<NamedPlace> coarse_pieces_;
  std::vector<GridLink> coarse_links_;
  std::vector<ShareTerm> share_terms_;
};

}  // namespace couplet::flow
