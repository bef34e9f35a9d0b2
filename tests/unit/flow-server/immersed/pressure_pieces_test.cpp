#include "flow-server/immersed/pressure_pieces.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr double side = 0.25;

/// Two dimensions, 6 x 4 cells; a sheet at x = 2.3 side cuts the column i = 2 into 0.3 and 0.7.
PlacedBodies with_sheet(double opening) {
  BodySurface sheet = flat_sheet({2.3 * side, -2, -1}, {0, 6, 0}, {0, 0, 3}, 4);
  sheet.opening.assign(sheet.position.size(), opening);
  return PlacedBodies(uniform_box({6, 4, 1}, side, 2), {sheet});
}

constexpr double of_nudge = 1e-8;  // surfaces are moved by 1e-9 of a cell

TEST(PressurePieces, JoinWhatFacesJoin) {
  const PlacedBodies placed = with_sheet(0);
  const PressurePieces& pieces = placed.bodies->pieces();
  ASSERT_EQ(pieces.split().cell.size(), 4u);  // the smaller parts, left of the sheet
  ASSERT_EQ(pieces.listed().size(), 4u);
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_EQ(pieces.split().cell[p][0], 2);
    const int part = placed.bodies->cut().further_parts()[static_cast<std::size_t>(pieces.listed()[p])];
    EXPECT_NEAR(placed.bodies->cut().parts()[static_cast<std::size_t>(part)].open_area, (1 + 2 * 0.3) * side * side,
                of_nudge);
  }
  // To the cell on the left by a whole face: area / distance = side * side / side, the depth being side. To each other
  // 0.3 of that.
  int n_left = 0, n_along = 0;
  for (const auto& link : pieces.split().links) {
    const bool has_left = link.a.piece < 0 || link.b.piece < 0;
    const PressureUnknown& other = link.a.piece < 0 ? link.a : link.b;
    if (has_left) {
      EXPECT_EQ(other.cell[0], 1);
    }
    EXPECT_NEAR(link.conductance, (has_left ? 1 : 0.3) * side, of_nudge);
    (has_left ? n_left : n_along) += 1;
  }
  EXPECT_EQ(n_left, 4);
  for (const PressurePieces::FaceShare& share : pieces.shares()) {
    const auto& [i, j, k] = share.face;
    if (j < 0 || j > 3 || i < 1 || i > 2) continue;
    if (share.direction == 0) {
      EXPECT_NEAR(share.share, i == 1 ? 0 : 1, 1e-7);  // single precision
    }
    if (share.direction == 1 && j < 3 && i == 2) {
      EXPECT_NEAR(share.share, 0.7, 1e-7);
    }
  }
  // Three faces between four pieces; those on the border of the box are closed.
  EXPECT_EQ(n_along, 3);
}

TEST(PressurePieces, TakeSlopesOnTheirOwnSide) {
  PlacedBodies placed = with_sheet(0);
  // Left of the sheet p = y, right of it p = 100 + 2 y: a jump that no slope may see.
  placed.set_pressure([](const Point& p) { return p[0] < 2.3 * side ? p[1] : 100 + 2 * p[1]; });
  const CutCells& cut = placed.bodies->cut();
  const PressurePieces& pieces = placed.bodies->pieces();
  for (std::size_t f = 0; f < cut.further_parts().size(); ++f) {
    const CellPart& part = cut.parts()[static_cast<std::size_t>(cut.further_parts()[f])];
    placed.bodies->piece_pressure[f] =
        centre_of_cell(placed.block, cut.cells()[static_cast<std::size_t>(part.cell)].cell)[1];
  }
  int n_seen = 0;
  for (int f = 0; f < static_cast<int>(cut.faces().size()); ++f) {
    const CutFace& face = cut.faces()[static_cast<std::size_t>(f)];
    const auto& [i, j, k] = face.face;
    if (j < 0 || (face.direction == 1 && j > 2)) continue;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      const bool is_left = face.direction == 0 ? i == 1 : p != face.centre_piece;
      const double slope = pieces.slope(face, piece, placed.pressure, placed.bodies->piece_pressure);
      EXPECT_NEAR(slope, face.direction == 0 ? 0 : is_left ? 1 : 2, 1e-12);  // 100 / side times round-off
      ++n_seen;
    }
    // The middle of a face in the column stands right of the sheet, at 0.5; on i = 1 the face is one piece.
    const double middle = pieces.middle_slope(f, placed.pressure, placed.bodies->piece_pressure);
    EXPECT_NEAR(middle, face.direction == 0 ? 0 : 2, 1e-12);
    EXPECT_EQ(pieces.has_plain_slope(face), face.direction == 1 || i == 2);
  }
  EXPECT_EQ(n_seen, 2 * 4 + 2 * 3);
}

TEST(PressurePieces, AnOpenSheetJoinsItsSidesInsideACell) {
  for (const double opening : {0.2, 0.5, 1.0, 1.75}) {
    const PlacedBodies placed = with_sheet(opening);
    const double open = std::min(opening, 1.0);
    double conductance = 0;  // of one cell
    for (const auto& link : placed.bodies->pieces().split().links)
      if (link.a.cell == link.b.cell && link.a.cell == Triple{2, 1, 0}) conductance += link.conductance;
    // Integral over the wall, side^2, of o / (1 - o + 0.02), over the width side.
    EXPECT_NEAR(conductance, side * open / (1 - open + 0.02), of_nudge * 50);
  }
}

}  // namespace
}  // namespace couplet::flow
