#include "flow-server/poisson/multigrid.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

// A block with fewer cells is worked off faster than messages to its neighbours arrive; measured with two ranks.
constexpr std::int64_t worthwhile_block = 16 * 16 * 16;

RankBoxes boxes_of(const BlockDecomposition& blocks) {
  RankBoxes boxes;
  for (int rank = 0; rank < blocks.n_ranks(); ++rank) boxes.push_back(blocks.owned(rank));
  return boxes;
}

/// The boxes of coarse cells over boxes of fine ones whose borders are borders of coarse cells.
RankBoxes boxes_over(const RankBoxes& fine, const std::array<Merging, 3>& merging) {
  RankBoxes coarse;
  for (const Box& box : fine) {
    Box over;
    for (int d = 0; d < 3 && !box.is_empty(); ++d) {
      over.begin[d] = merging[d].coarse_of(box.begin[d]);
      over.end[d] = merging[d].coarse_of(box.end[d] - 1) + 1;
    }
    coarse.push_back(over);
  }
  return coarse;
}

/// With the faces at the start of the whole, which belong to the first cells.
RankBoxes with_first_faces(RankBoxes boxes, const std::array<LevelAxis, 3>& axes) {
  for (Box& box : boxes)
    for (int d = 0; d < 3; ++d)
      if (!box.is_empty() && axes[d].has_terms && !axes[d].is_periodic && box.begin[d] == 0) --box.begin[d];
  return boxes;
}

std::array<bool, 3> periodicity(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].is_periodic, axes[1].is_periodic, axes[2].is_periodic};
}

int n_with_cells(const RankBoxes& boxes) {
  return static_cast<int>(std::count_if(boxes.begin(), boxes.end(), [](const Box& box) { return !box.is_empty(); }));
}

Triple n_cells_of(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].n_cells(), axes[1].n_cells(), axes[2].n_cells()};
}

std::int64_t n_all(const Triple& n) {
  return static_cast<std::int64_t>(n[0]) * n[1] * n[2];
}

Triple one_layer(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].has_terms, axes[1].has_terms, axes[2].has_terms};
}

RankBoxes with_neighbours(RankBoxes boxes, const std::array<LevelAxis, 3>& axes) {
  for (Box& box : boxes)
    if (!box.is_empty()) box = box.grown(one_layer(axes));
  return boxes;
}

/// Our own copy of the shares, with as many ghost layers as smoothing needs; these are not filled.
FaceFractions copied_shares(const FaceFractions& given, const BlockDecomposition& blocks,
                            const std::array<LevelAxis, 3>& axes) {
  FaceFractions share;
  const Triple sizes = blocks.mine().sizes(), layer = one_layer(axes);
  for (int d = 0; d < 3; ++d) {
    share[d] =
        Field<float>(sizes, {layer[0] * multigrid_depth, layer[1] * multigrid_depth, layer[2] * multigrid_depth});
    if (!blocks.has_cells()) continue;
    for (int k = -layer[2]; k < sizes[2]; ++k)
      for (int j = -layer[1]; j < sizes[1]; ++j)
        for (int i = -layer[0]; i < sizes[0]; ++i)
          if (given[d](i, j, k) > 0) share[d](i, j, k) = given[d](i, j, k);  // what is not written takes no memory
  }
  return share;
}

/// The same shares on the blocks of the level; ghost layers as above.
FaceFractions moved_shares(const FaceFractions& from, const RankBoxes& over, const BlockDecomposition& blocks,
                           const std::array<LevelAxis, 3>& axes) {
  Redistribution faces(blocks.communicator(), with_first_faces(over, axes), with_first_faces(boxes_of(blocks), axes),
                       n_cells_of(axes), periodicity(axes));
  FaceFractions share;
  for (int d = 0; d < 3; ++d) {
    share[d] = Field<float>(blocks.mine().sizes(), from[d].ghosts());
    faces.move(from[d], over[static_cast<std::size_t>(blocks.rank())].begin, share[d], blocks.mine().begin);
  }
  return share;
}

/// Nothing where no shape leaves blocks that are wide enough.
std::optional<Triple> shape_for(const Triple& n_cells, int n_blocks) {
  try {
    return choose_shape(n_cells, n_blocks);
  } catch (const report::SceneError&) {
    return std::nullopt;
  }
}

/// Partitions with that many blocks, or the next smaller number that can be cut with aligned borders.
std::array<Partition, 3> new_partitions(const LevelPlan& plan, int level, int n_blocks) {
  const Triple n = plan.n_cells(level);
  for (; n_blocks > 1; --n_blocks) {
    const std::optional<Triple> shape = shape_for(n, n_blocks);
    if (!shape) continue;
    const std::vector<Partition> aligned = aligned_partitions(plan, level, *shape);
    if (!aligned.empty()) return {aligned[0], aligned[1], aligned[2]};
  }
  return {Partition{{0, n[0]}}, Partition{{0, n[1]}}, Partition{{0, n[2]}}};
}

}  // namespace

std::array<LevelAxis, 3> finest_axes(const PressureProblem& problem) {
  std::array<LevelAxis, 3> axes;
  const std::array<bool, 3> is_periodic = problem.grid->is_periodic();
  for (int d = 0; d < 3; ++d) {
    const StretchedAxis& axis = problem.grid->axis[d];
    for (int i = 0; i < axis.n_cells(); ++i) axes[d].width.push_back(axis.width(i));
    axes[d].has_terms = d < problem.grid->n_dimensions;
    axes[d].is_periodic = is_periodic[d];
    axes[d].border_is_open = problem.open_share ? std::array<bool, 2>{true, true} : problem.border_is_open[d];
  }
  return axes;
}

std::array<Partition, 3> suitable_partitions(const StretchedGrid& grid, const Triple& shape) {
  PressureProblem problem;
  problem.grid = &grid;
  const std::array<LevelAxis, 3> axes = finest_axes(problem);
  if (can_colour(axes)) {
    const std::vector<Partition> aligned = aligned_partitions(plan_levels(axes), 0, shape);
    if (!aligned.empty()) return {aligned[0], aligned[1], aligned[2]};
  }
  const Triple n = grid.n_cells();
  return {equal_parts(n[0], shape[0], 1), equal_parts(n[1], shape[1], 1), equal_parts(n[2], shape[2], 1)};
}

Multigrid::Passage::Passage(const RankBoxes& over, const BlockDecomposition& blocks,
                            const std::array<LevelAxis, 3>& axes)
    : down(blocks.communicator(), over, boxes_of(blocks), n_cells_of(axes), periodicity(axes)),
      up(blocks.communicator(), boxes_of(blocks), with_neighbours(over, axes), n_cells_of(axes), periodicity(axes)) {
  const Box& mine = over[static_cast<std::size_t>(blocks.rank())];
  rhs = Field<float>(mine.sizes(), {0, 0, 0});
  phi = Field<float>(mine.sizes(), one_layer(axes));
  over_origin = mine.begin, block_origin = blocks.mine().begin;
}

void Multigrid::Passage::take_shares(const MultigridLevel& level, const RankBoxes& over) {
  const BlockDecomposition& blocks = level.decomposition();
  Redistribution faces(blocks.communicator(), with_first_faces(boxes_of(blocks), level.axes()),
                       with_neighbours(over, level.axes()), n_cells_of(level.axes()), periodicity(level.axes()));
  share.emplace();
  for (int d = 0; d < 3; ++d) {
    (*share)[d] = Field<float>(phi.sizes(), phi.ghosts());
    faces.move(level.share()[d], block_origin, (*share)[d], over_origin);
  }
}

Multigrid::Multigrid(const PressureProblem& problem) : plan_(plan_levels(finest_axes(problem))) {
  const BlockDecomposition& given = *problem.decomposition;
  RankBoxes over = boxes_of(given);  // where the right-hand side of the next level comes into being
  std::array<Partition, 3> partitions = given.partitions();
  std::optional<FaceFractions> share;  // of the next level, on the boxes `over`
  if (problem.open_share) share = copied_shares(*problem.open_share, given, plan_.axes.front());
  for (int l = 0; l < plan_.n_levels(); ++l) {
    const bool is_last = l + 1 == plan_.n_levels();
    const auto& axes = plan_.axes[static_cast<std::size_t>(l)];
    const int n_now = n_with_cells(over);
    const int n_worthwhile = static_cast<int>(std::max<std::int64_t>(1, n_all(plan_.n_cells(l)) / worthwhile_block));
    bool stays = is_last ? n_now == 1 : l == 0 || n_now <= n_worthwhile;
    for (int d = 0; d < 3 && stays; ++d) {
      if (partitions[d].n_parts() > 1) stays = partitions[d].smallest_part() >= smallest_block;
      for (const int start : partitions[d].start)
        stays = stays && (is_last || plan_.merging[static_cast<std::size_t>(l)][d].has_border_at(start));
    }
    if (!stays) partitions = new_partitions(plan_, l, is_last ? 1 : l == 0 ? n_now : std::min(n_now, n_worthwhile));
    blocks_.push_back(std::make_unique<BlockDecomposition>(given.communicator(), partitions, periodicity(axes)));
    const BlockDecomposition& blocks = *blocks_.back();
    std::unique_ptr<Passage> passage;
    if (boxes_of(blocks) != over) {
      passage = std::make_unique<Passage>(over, blocks, axes);
      if (share) share = moved_shares(*share, over, blocks, axes);
    }
    levels_.push_back(std::make_unique<MultigridLevel>(axes, blocks, std::move(share)));
    share.reset();
    if (passage && problem.open_share && l > 0) passage->take_shares(*levels_.back(), over);
    if (l == 0)
      entry_ = std::move(passage);
    else
      passages_.push_back(std::move(passage));
    if (is_last) break;
    const auto& merging = plan_.merging[static_cast<std::size_t>(l)];
    levels_.back()->join(merging, plan_.axes[static_cast<std::size_t>(l + 1)]);
    if (problem.open_share) share = levels_.back()->coarse_shares();
    over = boxes_over(boxes_of(blocks), merging);
    for (int d = 0; d < 3; ++d)
      for (int& start : partitions[d].start)
        start = start == merging[d].n_fine() ? merging[d].n_coarse() : merging[d].coarse_of(start);
  }
  if (levels_.back()->decomposition().has_cells()) coarsest_ = std::make_unique<CoarsestSolve>(*levels_.back());
}

void Multigrid::descend(std::size_t l) {
  MultigridLevel& level = *levels_[l];
  if (l + 1 == levels_.size()) {
    if (coarsest_) coarsest_->solve(level.rhs, level.phi);
    return;
  }
  MultigridLevel& coarse = *levels_[l + 1];
  Passage* passage = passages_[l].get();
  level.halo().exchange<float>({&level.rhs}, multigrid_depth);
  level.smooth_and_restrict(passage ? passage->rhs : coarse.rhs);
  if (passage) passage->down.move(passage->rhs, passage->over_origin, coarse.rhs, passage->block_origin);
  descend(l + 1);
  if (passage)
    passage->up.move(coarse.phi, passage->block_origin, passage->phi, passage->over_origin);
  else
    coarse.halo().exchange<float>({&coarse.phi}, 1);
  const FaceFractions* share = nullptr;
  if (coarse.has_shares()) share = passage ? &*passage->share : &coarse.share();
  level.add_correction(passage ? passage->phi : coarse.phi, share);
  level.halo().exchange<float>({&level.phi}, multigrid_depth);
  level.smooth();
}

void Multigrid::cycle() {
  MultigridLevel& finest = *levels_.front();
  if (entry_) entry_->down.move(entry_->rhs, entry_->over_origin, finest.rhs, entry_->block_origin);
  descend(0);
  if (entry_)
    entry_->up.move(finest.phi, entry_->block_origin, entry_->phi, entry_->over_origin);
  else
    finest.halo().exchange<float>({&finest.phi}, 1);
}

std::size_t Multigrid::n_bytes() const {
  std::size_t n = 0;
  for (const auto& level : levels_) n += level->n_bytes();
  const auto add = [&](const Passage& passage) {
    n += passage.rhs.n_bytes() + passage.phi.n_bytes();
    if (passage.share)
      for (const Field<float>& field : *passage.share) n += field.n_bytes();
  };
  if (entry_) add(*entry_);
  for (const auto& passage : passages_)
    if (passage) add(*passage);
  return n;
}

Traffic Multigrid::traffic() const {
  Traffic sum;
  for (const auto& level : levels_) sum += level->halo().traffic();
  const auto add = [&](const Passage& passage) { sum += passage.down.traffic(), sum += passage.up.traffic(); };
  if (entry_) add(*entry_);
  for (const auto& passage : passages_)
    if (passage) add(*passage);
  return sum;
}

}  // namespace couplet::flow
