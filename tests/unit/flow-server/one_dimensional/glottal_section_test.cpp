#include "flow-server/one_dimensional/glottal_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/extruded_fold.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;

constexpr double midplane = 0.0102;    // [m]
constexpr double smallest_gap = 2e-4;  // [m]
constexpr double exit_place = 0.012;   // [m]

struct Measured {
  Eigen::ArrayXd area, perimeter;
};

Measured measure(const surface::SurfaceMesh& mesh, const surface::NodeArray& displacement, bool half_length,
                 double exit = exit_place) {
  const StationAxis axis(140);
  const FoldSurface surface(mesh);
  GlottalSection section(surface, axis, {midplane, smallest_gap, half_length}, exit_place);
  NodePositions moved;
  surface.move(displacement, moved);
  Measured measured{Eigen::ArrayXd::Zero(140), Eigen::ArrayXd::Zero(140)};
  section.measure(moved, exit, measured.area, measured.perimeter);
  return measured;
}

surface::NodeArray no_motion(const surface::SurfaceMesh& mesh) {
  return surface::NodeArray::Zero(mesh.n_nodes(), 3);
}

double exact_height(double x) {
  return x < 0.010 ? 0.01 * std::sin(0.5 * 3.14159265358979324 * x / 0.010) : 0.01;
}

TEST(GlottalSection, AreaOfASmoothOutlineConvergesWithTheSquareOfTheFaceSize) {
  const StationAxis axis(140);
  for (const int n : {12, 24, 48}) {
    const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline, .n_across = n, .n_rows = 1});
    const Measured found = measure(mesh, no_motion(mesh), false);
    double error = 0;
    for (int k = 0; k < 140; ++k) {
      const double exact = 0.01 * 2 * (midplane - exact_height(axis.fraction()[k] * exit_place));
      error = std::max(error, std::abs(found.area[k] - exact));
    }
    // What a chord of the sine leaves out, y'' h^2 / 8, on both folds, for a quarter of a face; stations may miss the
    // worst point.
    const double h = 0.010 / (4 * n / 2.4), curvature = 0.01 * std::pow(0.5 * 3.14159265358979324 / 0.010, 2);
    const double chord = 2 * 0.01 * curvature * h * h / 8;
    EXPECT_LT(error, 1.05 * chord) << n;
    EXPECT_GT(error, 0.8 * chord) << n;
  }
}

TEST(GlottalSection, PerimeterIsThatOfTheRectangleOfEqualAreaAndLength) {
  const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline});
  const Measured found = measure(mesh, no_motion(mesh), false);
  for (int k = 0; k < 140; ++k) {
    EXPECT_DOUBLE_EQ(found.perimeter[k], 2 * (0.01 + found.area[k] / 0.01));
  }
}

TEST(GlottalSection, IntegratesAParabolicGapAlongTheLengthExactly) {
  const surface::SurfaceMesh mesh =
      make_surface({.outline = [](double t) { return Eigen::Vector2d(0.013 * t, 0.01 * t); }, .n_rows = 2});
  surface::NodeArray motion = no_motion(mesh);
  for (std::int64_t i = 0; i < mesh.n_nodes(); ++i) {
    const double z = mesh.node_position(i, 2) / 0.01;
    motion(i, 1) = -0.1 * mesh.node_position(i, 1) * z * (1 - z);
  }
  const Measured still = measure(mesh, no_motion(mesh), false), open = measure(mesh, motion, false);
  // The fold loses 0.1 z (1 - z) of its height, in the mean 1/60: two Gauss lines a row are exact up to cubics in z.
  for (int k = 0; k < 140; ++k) {
    const double lost = (2 * midplane * 0.01 - still.area[k]) / 60;
    EXPECT_NEAR(open.area[k] - still.area[k], lost, 1e-13 * open.area[k]);
  }
}

// A fold whose downstream face runs obliquely: at one station some lines still stand there and others do not.
TEST(GlottalSection, ErrorAtAnObliqueFaceFallsWithTheNumberOfStrips) {
  const StationAxis axis(140);
  const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline, .n_rows = 2});
  surface::NodeArray motion = no_motion(mesh);
  motion.col(0) = 0.2 * mesh.node_position.col(2);  // 2 mm over the length of 10 mm
  const FoldSurface surface(mesh);
  NodePositions moved;
  surface.move(motion, moved);
  const auto area_with = [&](int n_strips) {
    GlottalSection section(surface, axis, {midplane, smallest_gap, false, n_strips}, exit_place);
    Eigen::ArrayXd area = Eigen::ArrayXd::Zero(140), perimeter = Eigen::ArrayXd::Zero(140);
    section.measure(moved, 0.0125, area, perimeter);
    return area;
  };
  const Eigen::ArrayXd fine = area_with(64);
  double before = (area_with(1) - fine).abs().sum();
  for (const int n_strips : {2, 4, 8}) {
    const double error = (area_with(n_strips) - fine).abs().sum();
    EXPECT_LT(error, 0.7 * before) << n_strips;  // first order halves it on average; stations may fall badly
    before = error;
  }
}

TEST(GlottalSection, HalfOfASymmetricFoldGivesTheAreaOfTheWholeFold) {
  const surface::SurfaceMesh whole = make_surface({.outline = fold_outline, .n_rows = 8, .z_high = 0.02});
  const surface::SurfaceMesh half = make_surface({.outline = fold_outline, .n_rows = 4, .z_high = 0.01});
  const auto bulge = [](const surface::SurfaceMesh& mesh) {
    surface::NodeArray motion = surface::NodeArray::Zero(mesh.n_nodes(), 3);
    for (std::int64_t i = 0; i < mesh.n_nodes(); ++i) {
      const double z = mesh.node_position(i, 2);
      motion(i, 1) = 50 * z * (0.02 - z) * mesh.node_position(i, 1);
      motion(i, 0) = 20 * z * (0.02 - z) * mesh.node_position(i, 1);
    }
    return motion;
  };
  const Measured a = measure(whole, bulge(whole), false), b = measure(half, bulge(half), true);
  // Equal lines, summed in another order.
  for (int k = 0; k < 140; ++k) {
    EXPECT_NEAR(a.area[k], b.area[k], 1e-13 * a.area[k]);
    EXPECT_NEAR(a.perimeter[k], b.perimeter[k], 1e-13 * a.perimeter[k]);
  }
}

TEST(GlottalSection, CountsTheSmallestGapWhereTheFoldsMeet) {
  const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline});
  surface::NodeArray motion = no_motion(mesh);
  motion.col(1).setConstant(1e-3);
  const Measured found = measure(mesh, motion, false);
  EXPECT_NEAR(found.area.minCoeff(), smallest_gap * 0.01, 1e-15);
  EXPECT_GT(found.area[0], 0.01 * 0.015);
}

TEST(GlottalSection, SeesTheHighestPieceWhereTheSurfaceFoldsBack) {
  // The fold leans downstream: its face beyond the top hangs over, so that a station may cross it three times.
  const auto leaning = [](double t) {
    const Eigen::Vector2d p = fold_outline(t);
    return Eigen::Vector2d(p[0] + (t > 1.4 / 2.4 ? -0.004 * (t - 1.4 / 2.4) : 0), p[1]);
  };
  const surface::SurfaceMesh upright = make_surface({.outline = fold_outline, .n_across = 24});
  const surface::SurfaceMesh hanging = make_surface({.outline = leaning, .n_across = 24});
  const Measured a = measure(upright, no_motion(upright), false), b = measure(hanging, no_motion(hanging), false);
  for (int k = 0; k < 140; ++k) EXPECT_NEAR(a.area[k], b.area[k], 1e-15) << k;
}

TEST(GlottalSection, FollowsTheExitLine) {
  const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline, .n_across = 48});
  const StationAxis axis(140);
  const Measured found = measure(mesh, no_motion(mesh), false, 0.008);
  for (int k = 0; k < 140; ++k) {
    const double exact = 0.01 * 2 * (midplane - exact_height(axis.fraction()[k] * 0.008));
    EXPECT_NEAR(found.area[k], exact, 1.05 * 9.6e-9);  // the chord error of 48 faces, see above
  }
}

TEST(GlottalSection, RefusesASurfaceWithAHole) {
  surface::SurfaceMesh mesh = make_surface({.outline = fold_outline});
  const std::int64_t hole = 16 * 2 + 5, last = mesh.n_faces() - 1;
  mesh.face_node.segment(8 * hole, 8) = mesh.face_node.segment(8 * last, 8).eval();
  try {
    measure(mesh, no_motion(mesh), false);
    FAIL() << "accepted";
  } catch (const report::PeerError& error) {
    EXPECT_THAT(error.what(), HasSubstr("hole between z = 0.00333333 and 0.005 m"));
  }
}

TEST(GlottalSection, RefusesAMidplaneInsideTheFold) {
  const surface::SurfaceMesh mesh = make_surface({.outline = fold_outline});
  const StationAxis axis(20);
  const FoldSurface surface(mesh);
  EXPECT_THROW(GlottalSection(surface, axis, {0.009, smallest_gap, false}, exit_place), report::SceneError);
}

}  // namespace
}  // namespace couplet::flow
