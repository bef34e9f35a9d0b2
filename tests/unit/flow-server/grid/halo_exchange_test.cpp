// Started on 1, 2, 4 and 8 ranks.
#include "flow-server/grid/halo_exchange.hpp"

#include <gtest/gtest.h>

namespace couplet::flow {
namespace {

constexpr Triple n_cells{13, 17, 19};

/// A number that tells every cell of the whole from every other.
double mark(const Triple& cell) {
  return cell[0] + 100.0 * cell[1] + 10000.0 * cell[2];
}

int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

struct Case {
  Triple shape;
  std::array<bool, 3> is_periodic;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Triple shape : {Triple{1, 1, 1}, Triple{2, 1, 1}, Triple{1, 2, 1}, Triple{1, 1, 2}, Triple{1, 1, 4},
                             Triple{2, 2, 1}, Triple{1, 4, 1}, Triple{2, 2, 2}, Triple{1, 2, 4}, Triple{2, 1, 4}}) {
    if (shape[0] * shape[1] * shape[2] != n_ranks()) continue;
    for (const auto& periodic : {std::array<bool, 3>{false, false, false}, {true, true, true}, {false, true, false}})
      all.push_back({shape, periodic});
  }
  return all;
}

BlockDecomposition decompose(const Case& c) {
  return {MPI_COMM_WORLD,
          {equal_parts(n_cells[0], c.shape[0], 1), equal_parts(n_cells[1], c.shape[1], 1),
           equal_parts(n_cells[2], c.shape[2], 1)},
          c.is_periodic};
}

/// The cell of the whole that a ghost stands for; false beyond a border.
bool wrap(Triple& cell, const std::array<bool, 3>& is_periodic) {
  for (int d = 0; d < 3; ++d) {
    if (cell[d] >= 0 && cell[d] < n_cells[d]) continue;
    if (!is_periodic[d]) return false;
    cell[d] = (cell[d] + n_cells[d]) % n_cells[d];
  }
  return true;
}

template <class Number>
Field<Number> marked_field(const BlockDecomposition& blocks, int ghosts, double factor) {
  Field<Number> field(blocks.mine().sizes(), {ghosts, ghosts, ghosts});
  const Box& mine = blocks.mine();
  for (int k = 0; k < mine.size(2); ++k)
    for (int j = 0; j < mine.size(1); ++j)
      for (int i = 0; i < mine.size(0); ++i)
        field(i, j, k) = static_cast<Number>(factor * mark({i + mine.begin[0], j + mine.begin[1], k + mine.begin[2]}));
  return field;
}

template <class Number>
void expect_filled(const BlockDecomposition& blocks, const Field<Number>& field, int depth, double factor) {
  const Box& mine = blocks.mine();
  const Triple n = mine.sizes();
  int n_wrong = 0;
  for (int k = -depth; k < n[2] + depth; ++k)
    for (int j = -depth; j < n[1] + depth; ++j)
      for (int i = -depth; i < n[0] + depth; ++i) {
        Triple cell{i + mine.begin[0], j + mine.begin[1], k + mine.begin[2]};
        const bool is_inside = wrap(cell, blocks.is_periodic());
        n_wrong += field(i, j, k) != (is_inside ? static_cast<Number>(factor * mark(cell)) : Number(0));
      }
  EXPECT_EQ(n_wrong, 0);
}

TEST(HaloExchange, BringsEveryGhostFromItsOwner) {
  for (const Case& c : cases()) {
    const BlockDecomposition blocks = decompose(c);
    HaloExchange halo(blocks);
    for (const int depth : {1, 2, 4}) {
      Field<double> field = marked_field<double>(blocks, 4, 1);
      halo.exchange<double>({&field}, depth);
      expect_filled(blocks, field, depth, 1);
    }
  }
}

TEST(HaloExchange, BringsSeveralFieldsInOneMessageANeighbour) {
  for (const Case& c : cases()) {
    const BlockDecomposition blocks = decompose(c);
    HaloExchange halo(blocks);
    Field<float> first = marked_field<float>(blocks, 1, 1), second = marked_field<float>(blocks, 2, -1);
    halo.exchange<float>({&first}, 1);
    const auto messages_of_one = halo.traffic().messages;
    halo.exchange<float>({&first, &second}, 1);
    EXPECT_EQ(halo.traffic().messages, 2 * messages_of_one);
    expect_filled(blocks, first, 1, 1);
    expect_filled(blocks, second, 1, -1);
  }
}

/// Blocks one behind the other along z, four cells thick, no periodic direction.
BlockDecomposition stack_of_blocks() {
  return {MPI_COMM_WORLD,
          {equal_parts(n_cells[0], 1, 1), equal_parts(n_cells[1], 1, 1), equal_parts(4 * n_ranks(), n_ranks(), 1)},
          {false, false, false}};
}

TEST(HaloExchange, CountsWhatItSends) {
  // One message to each of the blocks below and above: two layers of 13 x 17 and of what stands beyond the borders
  // beside them.
  const BlockDecomposition blocks = stack_of_blocks();
  HaloExchange halo(blocks);
  Field<double> field = marked_field<double>(blocks, 2, 1);
  halo.exchange<double>({&field}, 2);
  const int n_beside = (blocks.rank() > 0 ? 1 : 0) + (blocks.rank() + 1 < n_ranks() ? 1 : 0);
  EXPECT_EQ(halo.traffic().messages, n_beside);
  EXPECT_EQ(halo.traffic().bytes, n_beside * 2 * (13 + 4) * (17 + 4) * static_cast<int>(sizeof(double)));
}

TEST(HaloExchange, CarriesWhatStandsBeyondABorderToTheNeighbourBesideIt) {
  const BlockDecomposition blocks = stack_of_blocks();
  HaloExchange halo(blocks);
  Field<double> field(blocks.mine().sizes(), {2, 2, 2});
  const int n_z = blocks.mine().size(2), rank = blocks.rank();
  for (int k = 0; k < n_z; ++k) field(-1, 3, k) = 7 + rank;
  halo.exchange<double>({&field}, 1);
  EXPECT_EQ(field(-1, 3, -1), rank > 0 ? 6 + rank : 0);  // 0: beyond the end of the stack nobody writes
  EXPECT_EQ(field(-1, 3, n_z), rank + 1 < n_ranks() ? 8 + rank : 0);
}

TEST(HaloExchange, OfATwoDimensionalGridHasNoLayersAlongZ) {
  const Triple shape = choose_shape({16, 16, 1}, n_ranks());
  const BlockDecomposition blocks(MPI_COMM_WORLD,
                                  {equal_parts(16, shape[0], 1), equal_parts(16, shape[1], 1), equal_parts(1, 1, 1)},
                                  {true, true, false});
  HaloExchange halo(blocks);
  Field<double> field(blocks.mine().sizes(), {2, 2, 0});
  const Box& mine = blocks.mine();
  for (int j = 0; j < mine.size(1); ++j)
    for (int i = 0; i < mine.size(0); ++i) field(i, j, 0) = mark({i + mine.begin[0], j + mine.begin[1], 0});
  halo.exchange<double>({&field}, 2);
  for (int j = -2; j < mine.size(1) + 2; ++j)
    for (int i = -2; i < mine.size(0) + 2; ++i)
      EXPECT_EQ(field(i, j, 0), mark({(i + mine.begin[0] + 16) % 16, (j + mine.begin[1] + 16) % 16, 0}));
}

}  // namespace
}  // namespace couplet::flow
