#include "flow-server/poisson/multigrid.hpp"

#include <algorithm>
#include <optional>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

// A block with fewer cells is worked off faster than messages to its neighbours arrive; measured with two ranks.
constexpr std::int64_t worthwhile_block = 16 * 16 * 16;

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

/// The same for the borders between them.
std::array<Partition, 3> partitions_over(std::array<Partition, 3> fine, const std::array<Merging, 3>& merging) {
  for (int d = 0; d < 3; ++d)
    for (int& start : fine[d].start)
      start = start == merging[d].n_fine() ? merging[d].n_coarse() : merging[d].coarse_of(start);
  return fine;
}

int n_with_cells(const RankBoxes& boxes) {
  return static_cast<int>(std::count_if(boxes.begin(), boxes.end(), [](const Box& box) { return !box.is_empty(); }));
}

std::int64_t n_all(const Triple& n) {
  return static_cast<std::int64_t>(n[0]) * n[1] * n[2];
}

/// With the ghost layers of a level.
RankBoxes with_smoothed_layers(RankBoxes boxes, const std::array<LevelAxis, 3>& axes) {
  Triple layers;
  for (int d = 0; d < 3; ++d) layers[d] = axes[d].has_terms ? multigrid_depth : 0;
  for (Box& box : boxes)
    if (!box.is_empty()) box = box.grown(layers);
  return boxes;
}

bool is_any(bool is, MPI_Comm communicator) {
  int n = is ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_INT, MPI_MAX, communicator);
  return n > 0;
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

Multigrid::Multigrid(const PressureProblem& problem) : plan_(plan_levels(finest_axes(problem))) {
  lay_out(problem);
  const Box everything = box_of(problem.decomposition->mine().sizes());
  update(problem, std::span(&everything, 1));
}

/// Which ranks hold which blocks of each level, and what goes between them.
void Multigrid::lay_out(const PressureProblem& problem) {
  using Faces = MultigridLevel::Faces;
  const Faces faces = !problem.open_share ? Faces::whole
                      : problem.split     ? Faces::with_shares_and_links
                                          : Faces::with_shares;
  const BlockDecomposition& given = *problem.decomposition;
  RankBoxes over = boxes_of(given);  // where the right-hand side of the next level comes into being
  std::array<Partition, 3> partitions = given.partitions();
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
    std::unique_ptr<LevelPassage> passage;
    if (boxes_of(blocks) != over) {
      passage = std::make_unique<LevelPassage>(over, blocks, axes);
      if (problem.open_share) {
        passage->share.emplace();
        for (Field<float>& field : *passage->share) field = Field<float>(passage->phi.sizes(), passage->phi.ghosts());
      }
    }
    levels_.push_back(std::make_unique<MultigridLevel>(axes, blocks, faces));
    if (l == 0)
      entry_ = std::move(passage);
    else
      passages_.push_back(std::move(passage));
    if (is_last) break;
    const auto& merging = plan_.merging[static_cast<std::size_t>(l)];
    levels_.back()->join(merging, plan_.axes[static_cast<std::size_t>(l + 1)]);
    over = boxes_over(boxes_of(blocks), merging);
    partitions = partitions_over(std::move(partitions), merging);
  }
  piece_passages_.resize(levels_.size());
}

/// On the finest level, at faces of the cells in the given boxes.
void Multigrid::take_shares_of(const PressureProblem& problem, std::span<const Box> changed) {
  const auto& axes = plan_.axes.front();
  const Triple sizes = problem.decomposition->mine().sizes();
  for (int d = 0; d < 3; ++d) {
    if (!problem.decomposition->has_cells() || !axes[d].has_terms) continue;
    Box known = box_of(sizes);
    --known.begin[d];
    CellMask faces(known);  // many boxes may share one
    for (Box box : changed) {
      --box.begin[d];
      faces.add(box);
    }
    faces.for_each([&](const Triple& cell) {
      const float share = (*problem.open_share)[d](cell[0], cell[1], cell[2]);
      if (!entry_)
        levels_.front()->set_share(d, cell, share);
      else if (float& place = (*entry_->share)[d](cell[0], cell[1], cell[2]); place != share)
        place = share;  // what is not written takes no memory
    });
  }
}

void Multigrid::update(const PressureProblem& problem, std::span<const Box> changed) {
  if (problem.open_share) {
    const BlockDecomposition& given = *problem.decomposition;
    take_shares_of(problem, changed);
    // Of the pieces of split cells on the next level: who has them, their links, their places there.
    std::array<Partition, 3> over_partitions = given.partitions();
    std::vector<GridLink> links;
    std::vector<NamedPlace> names, names_over;
    if (problem.split) {
      const std::vector<int> number = piece_numbers(*problem.split);
      links = own_links(*problem.split, number, given);
      names = piece_names(*problem.split, number, given);
      names_over = own_piece_names(*problem.split, names, given);
      piece_rhs_.assign(problem.split->cell.size(), 0.0f);
      piece_correction_.assign(problem.split->cell.size(), 0.0f);
    }
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      MultigridLevel& level = *levels_[l];
      const BlockDecomposition& blocks = level.decomposition();
      LevelPassage* passage = l == 0 ? entry_.get() : passages_[l - 1].get();
      if (passage) passage->bring_shares_to(level);
      links = links_in(with_smoothed_layers(boxes_of(blocks), level.axes()), links, blocks);
      const bool is_split = is_any(!links.empty(), given.communicator());
      level.update(is_split ? &links : nullptr);
      if (passage && l > 0) passage->take_shares_from(level);
      piece_passages_[l].reset();
      if (is_split) {
        const LevelPieces& pieces = *level.pieces();
        piece_passages_[l] = std::make_unique<PiecePassage>(PiecePassage{
            PieceExchange(given.communicator(), over_partitions, names_over, pieces.names()),
            PieceExchange(given.communicator(), blocks.partitions(), pieces.own_names(), l == 0 ? names : names_over)});
      }
      if (l + 1 == levels_.size()) break;
      const LevelTransfer& transfer = level.transfer();
      transfer.coarse_shares([&](int d, const Triple& cell, float share) {
        if (passages_[l])
          (*passages_[l]->share)[d](cell[0], cell[1], cell[2]) = share;
        else
          levels_[l + 1]->set_share(d, cell, share);
      });
      links = transfer.aggregates().coarse_links();
      names_over = transfer.aggregates().coarse_pieces();
      over_partitions = partitions_over(blocks.partitions(), plan_.merging[l]);
    }
  }
  if (levels_.back()->decomposition().has_cells()) coarsest_ = std::make_unique<CoarsestSolve>(*levels_.back());
}

void Multigrid::descend(std::size_t l) {
  MultigridLevel& level = *levels_[l];
  if (l + 1 == levels_.size()) {
    if (coarsest_) coarsest_->solve(level);
    return;
  }
  MultigridLevel& coarse = *levels_[l + 1];
  LevelPassage* passage = passages_[l].get();
  level.halo().exchange<float>({&level.rhs}, multigrid_depth);
  level.smooth_and_restrict(passage ? passage->rhs : coarse.rhs);
  if (passage) passage->down.move(passage->rhs, passage->over_origin, coarse.rhs, passage->block_origin);
  PiecePassage* pieces = piece_passages_[l + 1].get();
  if (pieces) pieces->down.move(level.transfer().coarse_pieces_rhs.data(), coarse.pieces()->rhs.data());
  descend(l + 1);
  const Field<float>& correction = fetch_coarse(l);
  const FaceFractions* share = nullptr;
  if (coarse.has_shares()) share = passage ? &*passage->share : &coarse.share();
  level.add_correction(correction, share);
  if (level.pieces()) {
    // Corrections of pieces are not interpolated: cells should see smoother ones.
    level.pieces()->exchange(level.pieces()->phi);
    level.smooth_pieces();
  }
  level.halo().exchange<float>({&level.phi}, multigrid_depth);
  if (level.pieces()) level.pieces()->exchange(level.pieces()->phi);
  level.smooth();
  level.smooth_pieces();
}

void Multigrid::cycle() {
  MultigridLevel& finest = *levels_.front();
  if (entry_) entry_->down.move(entry_->rhs, entry_->over_origin, finest.rhs, entry_->block_origin);
  PiecePassage* pieces = piece_passages_.front().get();
  if (pieces) pieces->down.move(piece_rhs_.data(), finest.pieces()->rhs.data());
  descend(0);
  return_finest();
}

Multigrid::Parts Multigrid::number_parts() {
  Parts parts;
  if (coarsest_) {
    parts = {coarsest_->n_parts(), coarsest_->n_sealed()};
  }
  const MPI_Comm communicator = blocks_.front()->communicator();
  int n[2] = {parts.n, parts.n_sealed};
  MPI_Allreduce(MPI_IN_PLACE, n, 2, MPI_INT, MPI_MAX, communicator);
  parts = {n[0], n[1]};
  // A part that ends below the coarsest level: where there was none, it is new and lies where something has changed.
  if (!has_part_alone_) {
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l) has_part_alone_ = has_part_alone(l) || has_part_alone_;
    has_part_alone_ = is_any(has_part_alone_, communicator);
  }
  if (!has_part_alone_ && (parts.n_sealed == 0 || parts.n == 1)) return parts;
  if (coarsest_) coarsest_->number_parts(*levels_.back());
  for (std::size_t l = levels_.size() - 1; l-- > 0;)
    parts.n_sealed = levels_[l]->number_parts(fetch_coarse(l), parts.n_sealed);
  return_finest();
  has_part_alone_ = parts.n_sealed > n[1];
  return {n[0] + parts.n_sealed - n[1], parts.n_sealed};
}

bool Multigrid::has_part_alone(std::size_t l) {
  MultigridLevel &level = *levels_[l], &coarse = *levels_[l + 1];
  if (LevelPieces* pieces = coarse.pieces()) std::fill(pieces->phi.begin(), pieces->phi.end(), 1.0f);
  bool is_alone = false;
  const auto look = [&](const auto& is_active) {
    const std::vector<float>& linked = level.transfer().coarse_pieces_phi;
    is_alone = level.decomposition().has_cells() && level.transfer().has_part_alone(is_active, linked);
  };
  if (passages_[l]) {
    const Triple sizes = coarse.decomposition().mine().sizes();
    for (int k = 0; k < sizes[2]; ++k)
      for (int j = 0; j < sizes[1]; ++j)
        for (int i = 0; i < sizes[0]; ++i)
          if (coarse.active().contains(i, j, k)) coarse.phi(i, j, k) = 1;
    const Field<float>& ones = fetch_coarse(l);
    look([&](const Triple& C) { return ones(C[0], C[1], C[2]) != 0; });
  } else {
    if (PiecePassage* pieces = piece_passages_[l + 1].get())
      pieces->up.move(coarse.pieces()->phi.data(), level.transfer().coarse_pieces_phi.data());
    look([&](const Triple& C) { return coarse.active().contains(C[0], C[1], C[2]); });
  }
  return is_alone;
}

const Field<float>& Multigrid::fetch_coarse(std::size_t l) {
  MultigridLevel& coarse = *levels_[l + 1];
  if (PiecePassage* pieces = piece_passages_[l + 1].get())
    pieces->up.move(coarse.pieces()->phi.data(), levels_[l]->transfer().coarse_pieces_phi.data());
  LevelPassage* passage = passages_[l].get();
  if (!passage) {
    coarse.halo().exchange<float>({&coarse.phi}, 1);
    return coarse.phi;
  }
  passage->up.move(coarse.phi, passage->block_origin, passage->phi, passage->over_origin);
  return passage->phi;
}

void Multigrid::return_finest() {
  MultigridLevel& finest = *levels_.front();
  if (PiecePassage* pieces = piece_passages_.front().get())
    pieces->up.move(finest.pieces()->phi.data(), piece_correction_.data());
  if (entry_)
    entry_->up.move(finest.phi, entry_->block_origin, entry_->phi, entry_->over_origin);
  else
    finest.halo().exchange<float>({&finest.phi}, 1);
}

std::size_t Multigrid::n_bytes() const {
  std::size_t n = 0;
  for (const auto& level : levels_) n += level->n_bytes();
  if (entry_) n += entry_->n_bytes();
  for (const auto& passage : passages_)
    if (passage) n += passage->n_bytes();
  return n;
}

Traffic Multigrid::traffic() const {
  Traffic sum;
  for (const auto& level : levels_) sum += level->traffic();
  for (const auto& pieces : piece_passages_)
    if (pieces) sum += pieces->down.traffic(), sum += pieces->up.traffic();
  const auto add = [&](const LevelPassage& passage) { sum += passage.down.traffic(), sum += passage.up.traffic(); };
  if (entry_) add(*entry_);
  for (const auto& passage : passages_)
    if (passage) add(*passage);
  return sum;
}

}  // namespace couplet::flow
