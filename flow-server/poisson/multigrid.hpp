#pragma once
// One V-cycle of the geometric multigrid, from the finest level down to a direct solve and back.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "flow-server/grid/redistribution.hpp"
#include "flow-server/poisson/coarsest_solve.hpp"
#include "flow-server/poisson/multigrid_level.hpp"

namespace couplet::flow {

/// The axes of the finest level of a problem. With open shares all borders count as open; the shares close them.
std::array<LevelAxis, 3> finest_axes(const PressureProblem& problem);

/// Parts of a grid that the multigrid can use without moving cells of its finest levels between ranks; equal parts
/// where there are none.
std::array<Partition, 3> suitable_partitions(const StretchedGrid& grid, const Triple& shape);

/// An approximate inverse of div grad in single precision. Levels whose blocks would be smaller than 4 cells, badly
/// aligned with coarse cells or too small to be worth messages live on fewer ranks, the last one on one.
class Multigrid {
 public:
  /// Collective. The problem must outlive this.
  explicit Multigrid(const PressureProblem& problem);

  /// On the blocks of the problem: the right-hand side, to be filled on the cells of the rank, and the correction that
  /// cycle() leaves, with at least one ghost layer, which is filled. Where borders are closed it is free up to a
  /// constant.
  Field<float>& rhs() { return entry_ ? entry_->rhs : levels_.front()->rhs; }
  Field<float>& correction() { return entry_ ? entry_->phi : levels_.front()->phi; }

  /// Collective.
  void cycle();

  int n_levels() const { return plan_.n_levels(); }
  const LevelPlan& plan() const { return plan_; }
  std::size_t n_bytes() const;
  Traffic traffic() const;

 private:
  /// Between the blocks of a level and other blocks of the same cells: those that lie over the blocks of the next finer
  /// level, or those of the problem.
  struct Passage {
    Passage(const RankBoxes& over, const BlockDecomposition& blocks, const std::array<LevelAxis, 3>& axes);
    void take_shares(const MultigridLevel& level, const RankBoxes& over);

    Redistribution down, up;
    Triple over_origin, block_origin;
    Field<float> rhs, phi;               // on the other blocks; phi with one ghost layer
    std::optional<FaceFractions> share;  // likewise, where the problem has shares
  };
  void descend(std::size_t level);

  LevelPlan plan_;
  std::vector<std::unique_ptr<BlockDecomposition>> blocks_;  // of each level
  std::vector<std::unique_ptr<MultigridLevel>> levels_;
  std::vector<std::unique_ptr<Passage>> passages_;  // from level l to l + 1; empty where blocks lie over blocks
  std::unique_ptr<Passage> entry_;                  // from the blocks of the problem to level 0
  std::unique_ptr<CoarsestSolve> coarsest_;
};

}  // namespace couplet::flow
