#include "flow-server/poisson/piece_rows.hpp"

#include <gtest/gtest.h>

#include "flow-server/poisson/split_links.hpp"

namespace couplet::flow {
namespace {

/// Four cells along x, 0.5 wide, 2 and 3 in the other directions; the second one has a piece.
struct CutCell {
  std::array<LevelAxis, 3> axes;
  SplitCells split;
  CutCell() {
    axes[0].width.assign(4, 0.5);
    axes[1].width = {2}, axes[2].width = {3};
    split.cell = {{1, 0, 0}};
    split.links = {{{{0, 0, 0}, -1}, {{1, 0, 0}, 0}, 12.0}, {{{1, 0, 0}, 0}, {{1, 0, 0}, -1}, 6.0}};
  }
};

TEST(PieceRows, RowsAreLinksOverTheVolumeOfTheirCell) {
  const CutCell cut;
  const PieceRows rows(cut.split, cut.axes, {0, 0, 0}, box_of({4, 1, 1}));
  Field<double> phi({4, 1, 1}, {1, 0, 0});
  phi(0, 0, 0) = 1, phi(1, 0, 0) = 4;
  const std::vector<double> piece_phi{2};
  ASSERT_EQ(rows.pieces().size(), 1u);
  ASSERT_EQ(rows.cells(0, 0).size(), 2u);
  const std::span<const double> pieces(piece_phi);
  EXPECT_DOUBLE_EQ(rows.applied(rows.pieces()[0], phi, pieces), (12.0 * (1 - 2) + 6.0 * (4 - 2)) / 3);
  EXPECT_DOUBLE_EQ(rows.applied(rows.cells(0, 0)[0], phi, pieces), 12.0 * (2 - 1) / 3);
  EXPECT_DOUBLE_EQ(rows.applied(rows.cells(0, 0)[1], phi, pieces), 6.0 * (2 - 4) / 3);
}

TEST(SplitLinks, LocalIndicesComeBackWithImagesAcrossAPeriodicDirection) {
  SplitCells split;
  split.cell = {{0, 0, 0}, {3, 0, 0}, {-1, 0, 0}, {4, 0, 0}};  // the last two are images
  split.links = {{{{3, 0, 0}, 1}, {{4, 0, 0}, 3}, 2.0}, {{{-1, 0, 0}, 2}, {{0, 0, 0}, 0}, 2.0}};
  const BlockDecomposition blocks(MPI_COMM_SELF, {Partition{{0, 4}}, Partition{{0, 1}}, Partition{{0, 1}}},
                                  {true, false, false});
  const std::vector<GridLink> own = own_links(split, piece_numbers(split), blocks);
  ASSERT_EQ(own.size(), 1u);  // given from both ends, one link of the whole
  EXPECT_EQ(own[0].cell, (Triple{3, 0, 0}));
  const LocalSplit local = localised(own, {0, 0, 0}, box_of({4, 1, 1}), {4, 1, 1}, {true, false, false});
  ASSERT_EQ(local.split.cell.size(), 4u);
  EXPECT_EQ(local.split.links.size(), 2u);
  EXPECT_EQ(local.name[0], local.name[2]);  // cells -1 and 3
  EXPECT_EQ(local.name[1], local.name[3]);  // cells 0 and 4
}

TEST(PieceExchange, GhostsGetTheValuesOfTheirOwnersAndUnknownNamesZero) {
  const BlockDecomposition blocks(MPI_COMM_SELF, {Partition{{0, 4}}, Partition{{0, 1}}, Partition{{0, 1}}}, {});
  const UnknownName known = name_of({-1, 0, 0}, 1, {4, 1, 1}), unknown = name_of({2, 0, 0}, 1, {4, 1, 1});
  PieceExchange exchange(MPI_COMM_SELF, blocks.partitions(), {{name_of({3, 0, 0}, 1, {4, 1, 1}), 0}},
                         {{known, 1}, {unknown, 2}});
  std::vector<double> values{5, -1, -1};
  exchange.move(values.data(), values.data());
  EXPECT_EQ(values, (std::vector<double>{5, 5, 0}));
}

}  // namespace
}  // namespace couplet::flow
