#include "flow-server/grid/active_cells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace couplet::flow {
namespace {

using testing::ElementsAre;

TEST(ActiveCells, OfAFullBlockAreOneIntervalARow) {
  const ActiveCells cells = ActiveCells::all(box_of({5, 2, 3}));
  EXPECT_EQ(cells.n_cells(), 30);
  EXPECT_TRUE(cells.is_full());
  EXPECT_THAT(cells.row(1, 2), ElementsAre(Interval{0, 5}));
}

TEST(ActiveCells, OfARingAreTwoIntervalsInTheMiddleAndNoneOutside) {
  const auto is_in_ring = [](int i, int j, int) {
    const int r2 = (i - 4) * (i - 4) + j * j;
    return r2 >= 4 && r2 <= 9;
  };
  const ActiveCells cells = ActiveCells::where({{0, -4, 0}, {9, 5, 1}}, is_in_ring);
  EXPECT_THAT(cells.row(-4, 0), ElementsAre());
  EXPECT_THAT(cells.row(0, 0), ElementsAre(Interval{1, 3}, Interval{6, 8}));
  EXPECT_FALSE(cells.is_full());
  std::int64_t n_cells = 0;
  for (int j = -4; j < 5; ++j)
    for (int i = 0; i < 9; ++i) {
      EXPECT_EQ(cells.contains(i, j, 0), is_in_ring(i, j, 0)) << i << " " << j;
      n_cells += is_in_ring(i, j, 0);
    }
  EXPECT_EQ(cells.n_cells(), n_cells);
  EXPECT_FALSE(cells.contains(4, 7, 0));
}

TEST(ActiveCells, OfRowsAreAskedForInOrderAndKeptAsGiven) {
  std::vector<std::array<int, 2>> asked;
  const ActiveCells cells =
      ActiveCells::of_rows({{-1, -1, 2}, {6, 1, 4}}, [&](int j, int k, std::vector<Interval>& intervals) {
        asked.push_back({j, k});
        if (j == -1 && k == 2) return;
        intervals.push_back({-1, 1});
        if (k == 3) intervals.push_back({j + 3, 6});
      });
  const std::vector<std::array<int, 2>> rows{{-1, 2}, {0, 2}, {-1, 3}, {0, 3}};
  EXPECT_EQ(asked, rows);
  EXPECT_THAT(cells.row(-1, 2), ElementsAre());
  EXPECT_THAT(cells.row(0, 2), ElementsAre(Interval{-1, 1}));
  EXPECT_THAT(cells.row(-1, 3), ElementsAre(Interval{-1, 1}, Interval{2, 6}));
  EXPECT_THAT(cells.row(0, 3), ElementsAre(Interval{-1, 1}, Interval{3, 6}));
  EXPECT_EQ(cells.n_cells(), 2 + 2 + 4 + 2 + 3);
  EXPECT_TRUE(cells.contains(5, 0, 3));
  EXPECT_FALSE(cells.contains(2, 0, 3));
}

}  // namespace
}  // namespace couplet::flow
