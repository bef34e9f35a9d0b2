#pragma once
// Between the blocks of a level and other blocks of the same cells.

#include <array>
#include <optional>

#include "flow-server/grid/redistribution.hpp"
#include "flow-server/poisson/multigrid_level.hpp"

namespace couplet::flow {

/// The box of each rank; ranks without cells have an empty one.
RankBoxes boxes_of(const BlockDecomposition& blocks);
std::array<bool, 3> periodicity(const std::array<LevelAxis, 3>& axes);

/// Values of a level on two sets of blocks: its own, and others - those that lie over the blocks of the next finer
/// level, or those of the problem.
struct LevelPassage {
  /// Collective. `over`: the other boxes of all ranks; `blocks`: those of the level.
  LevelPassage(const RankBoxes& over, const BlockDecomposition& blocks, const std::array<LevelAxis, 3>& axes);
  /// Collective, where there are shares: from the other blocks to the level, and with neighbours back.
  void bring_shares_to(MultigridLevel& level) const;
  void take_shares_from(const MultigridLevel& level);
  std::size_t n_bytes() const;

  RankBoxes over;
  Redistribution down, up;
  Triple over_origin, block_origin;
  Field<float> rhs, phi;               // on the other blocks; phi with one ghost layer
  std::optional<FaceFractions> share;  // likewise, where the problem has shares
};

}  // namespace couplet::flow
