#include "solid-server/output/orifice.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

constexpr double pi = std::numbers::pi;

/// A plate of 1 m x 0.1 m x 1 m over one quarter of a disc of radius 0.8 m around the origin, seen along y.
const SolidMesh plate = make_box_mesh({{1, 0.1, 1}, {2, 1, 2}});
const OrificeShape disc{"disc", {"y_max"}, 1, Eigen::Vector3d::Zero(), 0.8, 400};

NodeVectors moved(double x, double z) {
  NodeVectors displacement = NodeVectors::Zero(plate.n_nodes(), 4);
  displacement.col(0).setConstant(x);
  displacement.col(2).setConstant(z);
  return displacement;
}

// Counting cells of width h along a border of length l errs by less than h l.
constexpr double count_error = 0.004 * 2;

TEST(Orifice, IsOpenWhereNoFaceThrowsAShadow) {
  Orifice orifice(plate, disc, "here");
  EXPECT_NEAR(orifice.area(moved(0, 0)), 0.75 * pi * 0.64, count_error);
  EXPECT_NEAR(orifice.area(moved(-0.5, 5)), pi * 0.64, count_error);         // far beside it
  EXPECT_NEAR(orifice.area(moved(-0.5, -0.5)), pi * 0.64 - 1, count_error);  // around the middle, wholly inside
}

TEST(Orifice, ConvergesWithItsCells) {
  const auto error = [&](int n_cells) {
    OrificeShape fine = disc;
    fine.n_cells = n_cells;
    return std::abs(Orifice(plate, fine, "here").area(moved(0.01, 0.01)) -
                    (pi * 0.64 - (0.25 * pi * 0.64 - 2 * 0.8 * 0.01 + 0.0001)));
  };
  EXPECT_LE(error(64), 0.8 * 2 / 64);
  EXPECT_LE(error(1024), 0.8 * 2 / 1024);
}

TEST(Orifice, RefusesAnUnknownSurface) {
  OrificeShape wrong = disc;
  wrong.surfaces = {"lid"};
  EXPECT_THROW(Orifice(plate, wrong, "solid.orifice[0]"), report::SceneError);
}

}  // namespace
}  // namespace couplet::solid
