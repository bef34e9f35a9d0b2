#include "flow-server/grid/block_decomposition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(EqualParts, DifferByAtMostOneCellWithoutAlignment) {
  EXPECT_THAT(equal_parts(10, 3, 1).start, ElementsAre(0, 3, 6, 10));
  EXPECT_THAT(equal_parts(4, 1, 1).start, ElementsAre(0, 4));
}

TEST(EqualParts, StandOnMultiplesOfTheAlignment) {
  EXPECT_THAT(equal_parts(100, 3, 4).start, ElementsAre(0, 32, 68, 100));
}

TEST(EqualParts, GiveUpAlignmentBeforeABlockGetsTooSmall) {
  EXPECT_GE(equal_parts(13, 3, 8).smallest_part(), smallest_block);
}

TEST(Partition, KnowsTheOwnerOfACell) {
  const Partition partition{{0, 3, 6, 10}};
  EXPECT_EQ(partition.part_of(0), 0);
  EXPECT_EQ(partition.part_of(2), 0);
  EXPECT_EQ(partition.part_of(3), 1);
  EXPECT_EQ(partition.part_of(9), 2);
}

TEST(ChooseShape, CutsWhatLeavesTheLeastSurface) {
  EXPECT_EQ(choose_shape({64, 64, 64}, 8), (Triple{2, 2, 2}));
  EXPECT_EQ(choose_shape({400, 64, 64}, 4), (Triple{4, 1, 1}));
  // Of equal surfaces the one that keeps rows of memory whole.
  EXPECT_EQ(choose_shape({64, 64, 64}, 2), (Triple{1, 1, 2}));
  EXPECT_EQ(choose_shape({64, 64, 1}, 4), (Triple{2, 2, 1}));
}

TEST(ChooseShape, RefusesBlocksOfFewerThanFourCells) {
  EXPECT_EQ(choose_shape({8, 8, 8}, 8), (Triple{2, 2, 2}));
  try {
    choose_shape({7, 7, 7}, 8);
    FAIL() << "was not refused";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("8 ranks cannot share 7 x 7 x 7 cells"));
  }
}

class OneRank : public testing::Test {
 protected:
  static BlockDecomposition decomposition(std::array<bool, 3> is_periodic) {
    return {MPI_COMM_SELF, {equal_parts(8, 1, 1), equal_parts(6, 1, 1), equal_parts(1, 1, 1)}, is_periodic};
  }
};

TEST_F(OneRank, OwnsEverythingAndHasNoNeighbours) {
  const BlockDecomposition blocks = decomposition({false, false, false});
  EXPECT_EQ(blocks.mine(), box_of({8, 6, 1}));
  EXPECT_TRUE(blocks.is_at_border(0, 0));
  EXPECT_TRUE(blocks.is_at_border(1, 1));
  EXPECT_EQ(blocks.neighbour({1, 0, 0}), MPI_PROC_NULL);
}

TEST_F(OneRank, IsItsOwnNeighbourWherePeriodic) {
  const BlockDecomposition blocks = decomposition({true, false, false});
  EXPECT_FALSE(blocks.is_at_border(0, 0));
  EXPECT_EQ(blocks.neighbour({1, 0, 0}), 0);
  EXPECT_EQ(blocks.neighbour({1, 1, 0}), MPI_PROC_NULL);
}

TEST_F(OneRank, CannotHoldTwoBlocks) {
  EXPECT_THROW(BlockDecomposition(MPI_COMM_SELF, {equal_parts(8, 2, 1), equal_parts(6, 1, 1), equal_parts(1, 1, 1)},
                                  {false, false, false}),
               report::SceneError);
}

}  // namespace
}  // namespace couplet::flow
