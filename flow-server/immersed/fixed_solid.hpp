#pragma once
// Cells that bodies at rest keep from the flow for good.

#include <span>

#include "flow-server/boundary/space_time_value.hpp"
#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_surface.hpp"

namespace couplet::flow {

/// The cells inside closed bodies that never move, or outside lumens that never do, so far behind the walls that
/// nothing in the fluid asks for them: neither swept nor counted, and since nobody writes to them they take no memory
/// (Field). Where one of several lumens moves, what lies outside of all of them may be fluid later: then none counts.
class FixedSolid {
 public:
  /// None.
  FixedSolid() = default;
  /// Of a block and one layer of cells around it; surfaces that move and sheets are passed over.
  FixedSolid(const StretchedGrid& grid, const BlockDecomposition& decomposition, std::span<const BodySurface> surfaces);

  bool is_empty() const { return cells_.n_cells() == 0; }
  /// Local indices, at most one beyond the block.
  bool contains(const Triple& cell) const { return cells_.contains(cell[0], cell[1], cell[2]); }
  /// Of the cell around a point.
  bool contains(const Point& centre) const;

 private:
  const StretchedGrid* grid_ = nullptr;
  Triple origin_{};
  ActiveCells cells_ = ActiveCells::all({});
};

}  // namespace couplet::flow
