#include "flow-server/poisson/level_passage.hpp"

namespace couplet::flow {

namespace {

/// With the faces at the start of the whole, which belong to the first cells.
RankBoxes with_first_faces(RankBoxes boxes, const std::array<LevelAxis, 3>& axes) {
  for (Box& box : boxes)
    for (int d = 0; d < 3; ++d)
      if (!box.is_empty() && axes[d].has_terms && !axes[d].is_periodic && box.begin[d] == 0) --box.begin[d];
  return boxes;
}

Triple n_cells_of(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].n_cells(), axes[1].n_cells(), axes[2].n_cells()};
}

Triple one_layer(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].has_terms, axes[1].has_terms, axes[2].has_terms};
}

RankBoxes with_neighbours(RankBoxes boxes, const std::array<LevelAxis, 3>& axes) {
  for (Box& box : boxes)
    if (!box.is_empty()) box = box.grown(one_layer(axes));
  return boxes;
}

}  // namespace

RankBoxes boxes_of(const BlockDecomposition& blocks) {
  RankBoxes boxes;
  for (int rank = 0; rank < blocks.n_ranks(); ++rank) boxes.push_back(blocks.owned(rank));
  return boxes;
}

std::array<bool, 3> periodicity(const std::array<LevelAxis, 3>& axes) {
  return {axes[0].is_periodic, axes[1].is_periodic, axes[2].is_periodic};
}

LevelPassage::LevelPassage(const RankBoxes& boxes, const BlockDecomposition& blocks,
                           const std::array<LevelAxis, 3>& axes)
    : over(boxes),
      down(blocks.communicator(), over, boxes_of(blocks), n_cells_of(axes), periodicity(axes)),
      up(blocks.communicator(), boxes_of(blocks), with_neighbours(over, axes), n_cells_of(axes), periodicity(axes)) {
  const Box& mine = over[static_cast<std::size_t>(blocks.rank())];
  rhs = Field<float>(mine.sizes(), {0, 0, 0});
  phi = Field<float>(mine.sizes(), one_layer(axes));
  over_origin = mine.begin, block_origin = blocks.mine().begin;
}

void LevelPassage::bring_shares_to(MultigridLevel& level) const {
  const BlockDecomposition& blocks = level.decomposition();
  const auto& axes = level.axes();
  Redistribution faces(blocks.communicator(), with_first_faces(over, axes), with_first_faces(boxes_of(blocks), axes),
                       n_cells_of(axes), periodicity(axes));
  const Triple sizes = blocks.mine().sizes();
  for (int d = 0; d < 3; ++d) {
    Field<float> moved(sizes, one_layer(axes));
    faces.move((*share)[d], over_origin, moved, block_origin);
    if (!blocks.has_cells() || !axes[d].has_terms) continue;
    Box mine = box_of(sizes);
    if (blocks.is_at_border(d, 0)) --mine.begin[d];
    for (int k = mine.begin[2]; k < mine.end[2]; ++k)
      for (int j = mine.begin[1]; j < mine.end[1]; ++j)
        for (int i = mine.begin[0]; i < mine.end[0]; ++i) level.set_share(d, {i, j, k}, moved(i, j, k));
  }
}

void LevelPassage::take_shares_from(const MultigridLevel& level) {
  const BlockDecomposition& blocks = level.decomposition();
  Redistribution faces(blocks.communicator(), with_first_faces(boxes_of(blocks), level.axes()),
                       with_neighbours(over, level.axes()), n_cells_of(level.axes()), periodicity(level.axes()));
  for (int d = 0; d < 3; ++d) faces.move(level.share()[d], block_origin, (*share)[d], over_origin);
}

std::size_t LevelPassage::n_bytes() const {
  std::size_t n = rhs.n_bytes() + phi.n_bytes();
  if (share)
    for (const Field<float>& field : *share) n += field.n_bytes();
  return n;
}

}  // namespace couplet::flow
