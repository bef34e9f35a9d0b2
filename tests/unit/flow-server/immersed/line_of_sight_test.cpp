#include "flow-server/immersed/line_of_sight.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

/// Cells of width 1, 8 x 8 x 1.
struct Seen {
  explicit Seen(std::vector<BodySurface> given) : surfaces(std::move(given)) {
    crossings.update(surfaces);
    cut.update(surfaces);
    sight.update();
  }
  std::vector<BodySurface> surfaces;
  StretchedGrid grid = uniform_box({8, 8, 1}, 1, 2);
  EdgeCrossings crossings{grid, box_of({8, 8, 1}), 0};
  CutCells cut{grid, crossings};
  LineOfSight sight{cut};
};

/// At x = 3.7 from below the box up to y = `end`; its outer side is that of larger x.
BodySurface wall(double end, double opening = 0, double x = 3.7) {
  BodySurface sheet = flat_sheet({x, -2, -1}, {0, end + 2, 0}, {0, 0, 3}, 4);
  sheet.opening.assign(sheet.position.size(), opening);
  return sheet;
}

TEST(LineOfSight, EndsAtASheetAndKnowsItsSides) {
  const Seen seen({wall(10)});
  // Faces normal to y have their middles at x = 3.5 and 4.5, on either side.
  const Sight forth = seen.sight.to_neighbour(1, {3, 4, 0}, 0, 1), back = seen.sight.to_neighbour(1, {4, 4, 0}, 0, -1);
  EXPECT_EQ(forth.blocked, 1);
  EXPECT_EQ(forth.surface, 0);
  EXPECT_FALSE(forth.is_outer);
  EXPECT_EQ(back.blocked, 1);
  EXPECT_TRUE(back.is_outer);
  // Faces normal to x stand at x = 3 and 4; in the cell between them the sheet.
  EXPECT_EQ(seen.sight.to_neighbour(0, {2, 4, 0}, 0, 1).blocked, 1);
  EXPECT_EQ(seen.sight.to_neighbour(0, {3, 4, 0}, 0, 1).blocked, 0);
  EXPECT_EQ(seen.sight.across_cell({3, 4, 0}, 0, {2, 4, 0}, 0, {3, 4, 0}).blocked, 1);
  EXPECT_EQ(seen.sight.across_cell({3, 4, 0}, 0, {2, 4, 0}, 1, {3, 4, 0}).blocked, 0);
  EXPECT_EQ(seen.sight.across_cell({3, 4, 0}, 1, {3, 4, 0}, 0, {3, 4, 0}).blocked, 1);
  // Along the sheet nothing is in the way.
  for (const int step : {-1, 1}) {
    EXPECT_EQ(seen.sight.to_neighbour(1, {3, 4, 0}, 1, step).blocked, 0);
    EXPECT_EQ(seen.sight.to_neighbour(0, {3, 4, 0}, 1, step).blocked, 0);
  }
  EXPECT_FALSE(seen.sight.is_plainly_free(1, {3, 4, 0}, 0, 1));
  EXPECT_TRUE(seen.sight.is_plainly_free(1, {5, 4, 0}, 0, 1));
}

TEST(LineOfSight, GoesOnBeyondTheEndOfASheet) {
  const Seen seen({wall(4.4)});
  EXPECT_EQ(seen.sight.to_neighbour(1, {3, 2, 0}, 0, 1).blocked, 1);
  EXPECT_EQ(seen.sight.to_neighbour(1, {3, 3, 0}, 0, 1).blocked, 0);  // past the cell in which it ends
  EXPECT_EQ(seen.sight.to_neighbour(1, {3, 5, 0}, 0, 1).blocked, 0);
  EXPECT_EQ(seen.sight.to_neighbour(0, {2, 5, 0}, 0, 1).blocked, 0);
}

TEST(LineOfSight, IsPartlyFreeWhereASheetIsOpen) {
  const Seen seen({wall(10, 0.3)});
  EXPECT_NEAR(seen.sight.to_neighbour(1, {3, 4, 0}, 0, 1).blocked, 0.7, 1e-14);
  EXPECT_NEAR(seen.sight.across_cell({3, 4, 0}, 0, {2, 4, 0}, 0, {3, 4, 0}).blocked, 0.7, 1e-14);
  EXPECT_EQ(Seen({wall(10, 1)}).sight.to_neighbour(1, {3, 4, 0}, 0, 1).blocked, 0);
}

TEST(LineOfSight, OfAPieceIsThatOfItsSide) {
  const Seen seen({wall(10)});
  const int index = seen.cut.find_face(1, {3, 4, 0});
  ASSERT_GE(index, 0);
  const CutFace& face = seen.cut.faces()[static_cast<std::size_t>(index)];
  ASSERT_EQ(face.n_pieces, 2);
  for (int p = face.first_piece; p < face.first_piece + 2; ++p) {
    const bool is_left = p == face.centre_piece;  // x < 3.7
    const FacePiece& piece = seen.cut.pieces()[static_cast<std::size_t>(p)];
    EXPECT_EQ(seen.sight.sees_neighbour(piece, 1, {3, 4, 0}, 0, -1), is_left);
    EXPECT_EQ(seen.sight.sees_neighbour(piece, 1, {3, 4, 0}, 0, 1), !is_left);
  }
}

}  // namespace
}  // namespace couplet::flow
