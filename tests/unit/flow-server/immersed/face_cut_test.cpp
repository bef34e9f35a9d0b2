#include "flow-server/immersed/face_cut.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr double of_nudge =
    2e-8;  // surfaces are moved by up to 1.7e-9 of a cell, steep traces slide by more along edges

/// Traces in the face of the cell (1, 1, 1) normal to a direction, in the face's coordinates from 0 to 1.
class Face {
 public:
  explicit Face(int d) : d_(d), crossings_(grid_, box_of({3, 3, 3}), 0) {}

  /// A sheet through both places, beyond them by 5 at `from` and by `beyond` at `to`, right across the face. Its outer
  /// side is on the right of the way from one to the other. `surface`: a new one, or one more trace of that one.
  void add_trace(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int surface, double beyond = 5) {
    const Eigen::Vector2d along = (to - from).normalized();
    const Eigen::Vector2d start = from - 5 * along, way = to + beyond * along - start;
    Point corner{}, a{}, b{};
    const auto d = static_cast<std::size_t>(d_), e = (d + 1) % 3, f = (d + 2) % 3;
    corner[e] = 1 + start[0], corner[f] = 1 + start[1], corner[d] = -2;
    a[e] = way[0], a[f] = way[1], b[d] = 8;
    const BodySurface sheet = flat_sheet(corner, a, b, 3);
    if (surface == static_cast<int>(surfaces_.size())) {
      surfaces_.push_back(sheet);
      return;
    }
    BodySurface& whole = surfaces_[static_cast<std::size_t>(surface)];
    const auto n = static_cast<int>(whole.position.size());
    whole.position.insert(whole.position.end(), sheet.position.begin(), sheet.position.end());
    whole.velocity.insert(whole.velocity.end(), sheet.velocity.begin(), sheet.velocity.end());
    for (const auto& [p, q, r] : sheet.triangle) whole.triangle.push_back({p + n, q + n, r + n});
  }
  FaceCut cut() {
    crossings_.update(surfaces_);
    return FaceCut(crossings_, d_, {1, 1, 1});
  }

 private:
  int d_;
  StretchedGrid grid_ = uniform_box({3, 3, 3}, 1);
  EdgeCrossings crossings_;
  std::vector<BodySurface> surfaces_;
};

class FaceCutTest : public testing::TestWithParam<int> {};  // the direction of the face

TEST_P(FaceCutTest, WithoutACrossingIsOnePiece) {
  const FaceCut cut = Face(GetParam()).cut();
  EXPECT_EQ(cut.n_pieces(), 1);
  EXPECT_EQ(cut.n_chords(), 0);
  EXPECT_EQ(cut.share(0), 1);
  EXPECT_EQ(cut.centroid(0), Eigen::Vector2d(0.5, 0.5));
  for (int edge = 0; edge < 4; ++edge) {
    EXPECT_EQ(cut.n_segments(edge), 1);
    EXPECT_EQ(cut.piece_of(edge, 0), 0);
  }
}

TEST_P(FaceCutTest, OneChordParts2Trapezia) {
  Face face(GetParam());
  face.add_trace({0.3, 0}, {0.6, 1}, 0);
  const FaceCut cut = face.cut();
  ASSERT_EQ(cut.n_pieces(), 2);
  ASSERT_EQ(cut.n_chords(), 1);
  const int left = cut.piece_of(2, 0), right = cut.piece_of(3, 0);
  EXPECT_EQ(cut.chord(0).outer_piece, right);
  EXPECT_EQ(cut.chord(0).inner_piece, left);
  EXPECT_EQ(cut.centre_piece(), right);  // the chord passes the middle at 0.45
  EXPECT_EQ(cut.piece_of(0, 0), left);
  EXPECT_EQ(cut.piece_of(0, 1), right);
  EXPECT_EQ(cut.piece_of(1, 0), left);
  EXPECT_EQ(cut.piece_of(1, 1), right);
  EXPECT_FALSE(cut.has_lone_crossing());
  // Of a width w(y) = 0.3 + 0.3 y: area = int w, moments = int w^2 / 2 and int y w.
  const double area = 0.45, along = 0.105, across = 0.25;
  EXPECT_NEAR(cut.share(left), area, of_nudge);
  EXPECT_NEAR(cut.share(right), 1 - area, of_nudge);
  EXPECT_NEAR(cut.centroid(left)[0], along / area, of_nudge);
  EXPECT_NEAR(cut.centroid(left)[1], across / area, of_nudge);
  EXPECT_NEAR(cut.centroid(right)[0], (0.5 - along) / (1 - area), of_nudge);
  EXPECT_NEAR(cut.centroid(right)[1], (0.5 - across) / (1 - area), of_nudge);
}

TEST_P(FaceCutTest, TwoChordsOfTwoSurfacesAreNested) {
  Face face(GetParam());
  face.add_trace({0.4, 0}, {0, 0.4}, 0);
  face.add_trace({0.8, 0}, {0, 0.8}, 1);
  const FaceCut cut = face.cut();
  ASSERT_EQ(cut.n_pieces(), 3);
  const int corner = cut.piece_of(0, 0), between = cut.piece_of(0, 1), rest = cut.piece_of(0, 2);
  EXPECT_NEAR(cut.share(corner), 0.08, of_nudge);
  EXPECT_NEAR(cut.share(between), 0.24, of_nudge);
  EXPECT_NEAR(cut.share(rest), 0.68, of_nudge);
  EXPECT_EQ(cut.piece_of(2, 0), corner);
  EXPECT_EQ(cut.piece_of(2, 1), between);
  EXPECT_EQ(cut.piece_of(2, 2), rest);
  EXPECT_EQ(cut.centre_piece(), rest);
  EXPECT_NEAR(cut.centroid(corner)[0], 0.4 / 3, of_nudge);
  EXPECT_NEAR(cut.centroid(between)[1], (0.32 * 0.8 - 0.08 * 0.4) / 3 / 0.24, of_nudge);
}

TEST_P(FaceCutTest, TwoChordsOfOneSurfaceCutOffTwoCorners) {
  Face face(GetParam());
  face.add_trace({0, 0.3}, {0.3, 0}, 0);
  face.add_trace({1, 0.6}, {0.6, 1}, 0);
  const FaceCut cut = face.cut();
  ASSERT_EQ(cut.n_pieces(), 3);
  ASSERT_EQ(cut.n_chords(), 2);
  EXPECT_NEAR(cut.share(cut.piece_of(0, 0)), 0.045, of_nudge);
  EXPECT_NEAR(cut.share(cut.piece_of(1, 1)), 0.08, of_nudge);
  EXPECT_NEAR(cut.share(cut.centre_piece()), 0.875, of_nudge);
  for (int c = 0; c < 2; ++c) EXPECT_NE(cut.chord(c).outer_piece, cut.chord(c).inner_piece);
}

TEST_P(FaceCutTest, ACrossingWithoutAPartnerPartsNothing) {
  Face face(GetParam());
  face.add_trace({0.3, 0}, {0.4, 0.5}, 0, 0);
  const FaceCut cut = face.cut();
  EXPECT_TRUE(cut.has_lone_crossing());
  EXPECT_EQ(cut.n_chords(), 0);
  EXPECT_EQ(cut.n_pieces(), 1);
  EXPECT_NEAR(cut.share(0), 1, 1e-15);
  EXPECT_EQ(cut.n_segments(0), 2);
}

TEST_P(FaceCutTest, ChordsOfTwoSurfacesThatCrossLeaveSharesThatSumToOne) {
  for (const double slope : {0.0, 0.2, 0.45}) {
    Face face(GetParam());
    face.add_trace({0.5 - slope, 0}, {0.5 + slope, 1}, 0);
    face.add_trace({0, 0.5 + slope}, {1, 0.5 - slope}, 1);
    const FaceCut cut = face.cut();
    EXPECT_EQ(cut.n_pieces(), 4);
    double sum = 0;
    for (int piece = 0; piece < cut.n_pieces(); ++piece) {
      EXPECT_GE(cut.share(piece), 0);
      // Outlines go through the ends of the chords: symmetric to a quarter turn here, as these are.
      EXPECT_NEAR(cut.share(piece), 0.25, of_nudge) << slope;
      sum += cut.share(piece);
    }
    EXPECT_NEAR(sum, 1, 1e-15 * 4);  // four roundings
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, FaceCutTest, testing::Values(0, 1, 2));

}  // namespace
}  // namespace couplet::flow
