#include "flow-server/grid/stretched_axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;

StretchedAxis closed_axis(std::vector<double> faces) {
  return StretchedAxis(std::move(faces), false);
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "";
}

TEST(StretchedAxis, AnswersPlaceAndSizeOfItsCells) {
  const StretchedAxis axis = closed_axis({0, 1, 3});
  EXPECT_EQ(axis.n_cells(), 2);
  EXPECT_EQ(axis.width(1), 2);
  EXPECT_EQ(axis.centre(1), 2);
  EXPECT_EQ(axis.distance(0), 1.5);
  EXPECT_EQ(axis.smallest_width(), 1);
  EXPECT_EQ(axis.largest_width(), 2);
  EXPECT_EQ(axis.largest_growth(), 2);
}

TEST(StretchedAxis, MirrorsItsCellsBeyondAWall) {
  const StretchedAxis axis = closed_axis({0, 1, 3, 7});
  EXPECT_EQ(axis.width(-1), 1);
  EXPECT_EQ(axis.width(-2), 2);
  EXPECT_EQ(axis.width(3), 4);
  EXPECT_EQ(axis.width(4), 2);
  EXPECT_EQ(axis.face(-1), -1);
  EXPECT_EQ(axis.face(4), 11);
}

TEST(StretchedAxis, RepeatsItselfWherePeriodic) {
  const StretchedAxis axis({0, 1, 3, 7}, true);
  EXPECT_EQ(axis.width(-1), 4);
  EXPECT_EQ(axis.width(3), 1);
  EXPECT_EQ(axis.face(-1), -4);
  EXPECT_EQ(axis.face(5), 10);
}

TEST(StretchedAxis, RefusesFacesThatDoNotRise) {
  EXPECT_THAT(refusal([] { closed_axis({0, 1, 1}); }), HasSubstr("face 2 at 1 m is not beyond face 1 at 1 m"));
  EXPECT_THAT(refusal([] { closed_axis({0, std::nan("")}); }), HasSubstr("face 1 at nan m"));
}

TEST(StretchedFaces, AreUniformInFineRegionsAndGrowSmoothlyOutside) {
  const double growth = 1.1;
  const auto faces = stretched_faces(-4, 10, {{-1, 1, 0.05}, {3, 4, 0.1}}, growth, 0.8);
  const StretchedAxis axis = closed_axis(faces);
  EXPECT_EQ(axis.start(), -4);
  EXPECT_EQ(axis.end(), 10);
  int n_fine = 0;
  for (int i = 0; i < axis.n_cells(); ++i) {
    const double x = axis.centre(i);
    const double width = x > -1 && x < 1 ? 0.05 : x > 3 && x < 4 ? 0.1 : 0;
    if (width == 0) continue;
    EXPECT_NEAR(axis.width(i), width, 1e-12);
    ++n_fine;
  }
  EXPECT_EQ(n_fine, 40 + 10);
  EXPECT_NEAR(axis.smallest_width(), 0.05, 1e-12);
  // Whole cells must fill each gap: the remainder of at most half a cell is spread over its cells.
  EXPECT_LT(axis.largest_growth(), 1 + 1.6 * (growth - 1));
  EXPECT_LT(axis.largest_width(), 0.9);
}

TEST(StretchedFaces, WithoutRegionAreUniform) {
  const StretchedAxis axis = closed_axis(stretched_faces(0, 1, {}, 1.1, 0.1));
  EXPECT_EQ(axis.n_cells(), 10);
  EXPECT_NEAR(axis.largest_growth(), 1, 1e-12);
}

TEST(StretchedFaces, RefuseRegionsThatOverlapOrLeaveTheAxis) {
  EXPECT_THAT(refusal([] {
                stretched_faces(0, 10, {{1, 3, 0.1}, {2, 4, 0.1}}, 1.1, 1);
              }),
              HasSubstr("from 2 to 4 m does not lie between 3 and 10 m"));
  EXPECT_THAT(refusal([] { stretched_faces(0, 10, {{8, 11, 0.1}}, 1.1, 1); }), HasSubstr("from 8 to 11 m"));
}

TEST(StretchedFaces, RefuseWhatWouldNotBeSmooth) {
  // One wide cell is left between the regions: neighbours differ seven times.
  EXPECT_THAT(refusal([] {
                stretched_faces(0, 40, {{0, 10, 0.1}, {11, 40, 1}}, 1.05, 1);
              }),
              HasSubstr("neighbouring cells would differ by a factor of"));
}

TEST(StretchedFaces, RefuseMoreCellsThanAnyMachineHolds) {
  EXPECT_THAT(refusal([] {
                stretched_faces(0, 2, {{0, 0.1, 1e-9}}, 1.1, 1);
              }),
              HasSubstr("would have more than 100000 cells"));
  EXPECT_THAT(refusal([] { stretched_faces(0, 2, {}, 1.1, 1e-9); }), HasSubstr("more than 100000 cells"));
}

TEST(SymmetricallyStretchedFaces, AreAsWideAtTheEndsAsAsked) {
  for (const int n : {40, 41}) {
    const StretchedAxis axis = closed_axis(symmetrically_stretched_faces(-1, 1, n, 20));
    EXPECT_EQ(axis.n_cells(), n);
    EXPECT_NEAR(axis.width(0) / axis.smallest_width(), 20, 1e-9) << n;
    for (int i = 0; i < n; ++i) EXPECT_NEAR(axis.width(i), axis.width(n - 1 - i), 1e-12) << n;
  }
}

}  // namespace
}  // namespace couplet::flow
