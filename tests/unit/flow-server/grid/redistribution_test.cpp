// Started on 1, 2, 4 and 8 ranks.
#include "flow-server/grid/redistribution.hpp"

#include <gtest/gtest.h>

#include "flow-server/grid/block_decomposition.hpp"

namespace couplet::flow {
namespace {

constexpr Triple n_cells{9, 16, 10};

double mark(const Triple& cell) {
  return 1 + cell[0] + 100.0 * cell[1] + 10000.0 * cell[2];
}

int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

int rank() {
  int r = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &r);
  return r;
}

/// Equal parts of one direction for the first `n` ranks; nothing for the rest.
RankBoxes slabs(int direction, int n) {
  RankBoxes boxes(static_cast<std::size_t>(n_ranks()));
  for (int r = 0; r < n; ++r) {
    Box& box = boxes[static_cast<std::size_t>(r)];
    box = box_of(n_cells);
    box.begin[direction] = n_cells[direction] * r / n;
    box.end[direction] = n_cells[direction] * (r + 1) / n;
  }
  return boxes;
}

Field<double> marked(const Box& box) {
  Field<double> field(box.sizes(), {0, 0, 0});
  for (int k = 0; k < box.size(2); ++k)
    for (int j = 0; j < box.size(1); ++j)
      for (int i = 0; i < box.size(0); ++i)
        field(i, j, k) = mark({box.begin[0] + i, box.begin[1] + j, box.begin[2] + k});
  return field;
}

TEST(Redistribution, ThereAndBackEachValueIsWhereItWas) {
  const RankBoxes from = slabs(2, n_ranks()), to = slabs(1, (n_ranks() + 1) / 2);
  const Box here = from[static_cast<std::size_t>(rank())], there = to[static_cast<std::size_t>(rank())];
  Redistribution go(MPI_COMM_WORLD, from, to, n_cells, {}), come(MPI_COMM_WORLD, to, from, n_cells, {});
  const Field<double> start = marked(here), expected = marked(there);
  Field<double> moved(there.sizes(), {0, 0, 0}), back(here.sizes(), {0, 0, 0});
  go.move(start, here.begin, moved, there.begin);
  for (int k = 0; k < there.size(2); ++k)
    for (int j = 0; j < there.size(1); ++j)
      for (int i = 0; i < there.size(0); ++i) ASSERT_EQ(moved(i, j, k), expected(i, j, k));
  come.move(moved, there.begin, back, here.begin);
  for (int k = 0; k < here.size(2); ++k)
    for (int j = 0; j < here.size(1); ++j)
      for (int i = 0; i < here.size(0); ++i) ASSERT_EQ(back(i, j, k), start(i, j, k));
}

TEST(Redistribution, GhostsAroundPeriodicDirectionsArriveAndOthersStay) {
  const RankBoxes from = slabs(2, n_ranks());
  RankBoxes to = slabs(1, n_ranks());
  const Box mine = to[static_cast<std::size_t>(rank())];
  for (Box& box : to) box = box.grown({1, 1, 1});
  const Box here = from[static_cast<std::size_t>(rank())];
  Redistribution go(MPI_COMM_WORLD, from, to, n_cells, {true, true, false});
  Field<double> moved(mine.sizes(), {1, 1, 1});
  go.move(marked(here), here.begin, moved, mine.begin);
  for (int k = -1; k <= mine.size(2); ++k)
    for (int j = -1; j <= mine.size(1); ++j)
      for (int i = -1; i <= mine.size(0); ++i) {
        const int x = (mine.begin[0] + i + n_cells[0]) % n_cells[0], y = (mine.begin[1] + j + n_cells[1]) % n_cells[1];
        const int z = mine.begin[2] + k;
        ASSERT_EQ(moved(i, j, k), z < 0 || z >= n_cells[2] ? 0 : mark({x, y, z}));
      }
}

TEST(Redistribution, OneMessageGoesToEachRankThatWantsSomething) {
  const RankBoxes from = slabs(2, n_ranks()), to = slabs(2, 1);
  const Box here = from[static_cast<std::size_t>(rank())], there = to[static_cast<std::size_t>(rank())];
  Redistribution gather(MPI_COMM_WORLD, from, to, n_cells, {});
  Field<double> moved(there.sizes(), {0, 0, 0});
  gather.move(marked(here), here.begin, moved, there.begin);
  EXPECT_EQ(gather.traffic().messages, rank() == 0 ? 0 : 1);
  EXPECT_EQ(gather.traffic().bytes, rank() == 0 ? 0 : here.n_cells() * 8);
}

}  // namespace
}  // namespace couplet::flow
