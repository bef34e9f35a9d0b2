#pragma once
// One V-cycle of the geometric multigrid, from the finest level down to a direct solve and back.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "flow-server/poisson/coarsest_solve.hpp"
#include "flow-server/poisson/level_passage.hpp"

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

  /// Collective. Shares of the problem have changed at faces of cells within the given boxes (local indices), or split
  /// cells anywhere; what depends on them is made anew on all levels. The problem must have split cells if and only if
  /// it had them in the beginning.
  void update(const PressureProblem& problem, std::span<const Box> changed);

  /// On the blocks of the problem: the right-hand side, to be filled on the cells of the rank, and the correction that
  /// cycle() leaves, with at least one ghost layer, which is filled. Where borders are closed it is free up to a
  /// constant.
  Field<float>& rhs() { return entry_ ? entry_->rhs : levels_.front()->rhs; }
  Field<float>& correction() { return entry_ ? entry_->phi : levels_.front()->phi; }

  /// The same for the further pieces of split cells, in the order of the list of the problem; the correction with
  /// ghosts. Empty where no cell is split.
  std::vector<float>& piece_rhs() { return piece_rhs_; }
  const std::vector<float>& piece_correction() const { return piece_correction_; }

  /// Collective.
  void cycle();

  /// Parts of the fluid that are not connected with each other.
  struct Parts {
    int n = 0;         // of all
    int n_sealed = 0;  // without an open border
  };
  /// Collective, where the problem has shares. Where several parts are sealed, or one of several, correction() and
  /// piece_correction() become the numbers of the sealed parts that unknowns belong to, from 1 on, and -1 in others.
  Parts number_parts();

  int n_levels() const { return plan_.n_levels(); }
  const LevelPlan& plan() const { return plan_; }
  std::size_t n_bytes() const;
  Traffic traffic() const;

 private:
  void lay_out(const PressureProblem& problem);
  void take_shares_of(const PressureProblem& problem, std::span<const Box> changed);
  bool has_part_alone(std::size_t level);  // an unknown that belongs to nothing on the next one
  void descend(std::size_t level);
  const Field<float>& fetch_coarse(std::size_t level);  // phi of the next level over the block of this one
  void return_finest();                                 // phi of the finest level to the blocks of the problem

  LevelPlan plan_;
  std::vector<std::unique_ptr<BlockDecomposition>> blocks_;  // of each level
  std::vector<std::unique_ptr<MultigridLevel>> levels_;
  std::vector<std::unique_ptr<LevelPassage>> passages_;  // from level l to l + 1; empty where blocks lie over blocks
  std::unique_ptr<LevelPassage> entry_;                  // from the blocks of the problem to level 0
  /// Where the cells of a level are split: from the pieces over the next finer level (of the problem) and back.
  struct PiecePassage {
    PieceExchange down, up;
  };
  std::vector<std::unique_ptr<PiecePassage>> piece_passages_;  // (n_levels) to each level
  std::vector<float> piece_rhs_, piece_correction_;
  bool has_part_alone_ = false;  // on any rank and level, when that was last asked
  std::unique_ptr<CoarsestSolve> coarsest_;
};

}  // namespace couplet::flow
