#include "flow-server/one_dimensional/pressure_force.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/flow-server/extruded_fold.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;
constexpr int n_axis_stations = 40;

/// A flow whose pressure is p(x) at the stations between x = 0 and x = exit.
GlottalSolution flow_with(const StationAxis& axis, double inlet, double exit, const std::function<double(double)>& p) {
  GlottalSolution flow;
  flow.position = inlet + axis.fraction() * (exit - inlet);
  flow.exit = exit;
  flow.pressure = flow.position.unaryExpr(p);
  return flow;
}

surface::NodeArray force_on(const surface::SurfaceMesh& mesh, const surface::NodeArray& motion, double inlet,
                            double exit, const std::function<double(double)>& p) {
  const StationAxis axis(n_axis_stations);
  const FoldSurface surface(mesh);
  PressureForce pressure_force(surface, axis);
  NodePositions moved;
  surface.move(motion, moved);
  surface::NodeArray force(mesh.n_nodes(), 3);
  pressure_force.find(moved, flow_with(axis, inlet, exit, p), {p(inlet), p(exit)}, force);
  return force;
}

surface::NodeArray wild_motion(const surface::SurfaceMesh& mesh) {
  surface::NodeArray motion(mesh.n_nodes(), 3);
  for (std::int64_t i = 0; i < mesh.n_nodes(); ++i) {
    const auto X = mesh.node_position.row(i);
    motion.row(i) << 1e-3 * std::sin(700 * X[1] + 300 * X[2]), 2e-3 * std::cos(500 * X[0] - 400 * X[2]),
        1e-3 * std::sin(600 * X[0]);
  }
  return motion;
}

Eigen::Vector2d circle(double t) {
  return {0.005 - 0.004 * std::cos(2 * pi * t), 0.004 * std::sin(2 * pi * t)};
}

TEST(PressureForce, ConstantPressureOnAFlatPatchIsPressureTimesArea) {
  const surface::SurfaceMesh mesh =
      make_surface({.outline = [](double t) { return Eigen::Vector2d(0.01 * t, 0.003); }, .n_across = 3, .n_rows = 2});
  const auto force = force_on(mesh, surface::NodeArray::Zero(mesh.n_nodes(), 3), 0, 0.01, [](double) { return 800.0; });
  const double exact = -800 * 0.01 * 0.01;
  EXPECT_NEAR(force.col(0).sum(), 0, 1e-14 * std::abs(exact));
  EXPECT_NEAR(force.col(1).sum(), exact, 1e-14 * std::abs(exact));
  EXPECT_NEAR(force.col(2).sum(), 0, 1e-14 * std::abs(exact));
}

TEST(PressureForce, ConstantPressureOnADeformedPatchDependsOnItsRimOnly) {
  // The vector area of a surface is fixed by its rim: moving the nodes inside it must not change the force.
  const ExtrudedFold fold{.outline = fold_outline, .n_across = 4, .n_rows = 3};
  const surface::SurfaceMesh mesh = make_surface(fold);
  const surface::NodeArray motion = wild_motion(mesh);
  surface::NodeArray inside = motion;
  for (int j = 1; j < 2 * fold.n_rows; ++j) {
    for (int i = 1 + j % 2; i < 2 * fold.n_across; i += 1 + j % 2) {
      inside(node_number(fold, i, j), 0) += 1e-3;
      inside(node_number(fold, i, j), 1) -= 2e-3;
    }
  }
  const auto p = [](double) { return 1000.0; };
  const auto a = force_on(mesh, motion, 0, 0.01, p), b = force_on(mesh, inside, 0, 0.01, p);
  const double size = 1000 * 0.01 * 0.02;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(a.col(c).sum(), b.col(c).sum(), 1e-13 * size);  // Gauss points exact: round-off
  EXPECT_GT((a - b).cwiseAbs().maxCoeff(), 1e-3 * size);
}

TEST(PressureForce, ConstantPressureOnAClosedTubeHasNoResultant) {
  const surface::SurfaceMesh mesh = make_surface({.outline = circle, .n_across = 10, .n_rows = 2});
  const auto force = force_on(mesh, surface::NodeArray::Zero(mesh.n_nodes(), 3), 0, 0.01, [](double) { return 500.0; });
  const double size = 500 * 0.008 * 0.01;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(force.col(c).sum(), 0, 1e-13 * size);
}

TEST(PressureForce, LinearPressureOnAClosedTubeIsBuoyancyToHighOrder) {
  // Gauss's theorem: resultant = - gradient times enclosed volume. The tube is drawn clockwise: its normals point out
  // of it.
  const double gradient = 1e5;
  double last_error = 0;
  for (const int n : {6, 12, 24}) {
    const surface::SurfaceMesh mesh = make_surface({.outline = circle, .n_across = n, .n_rows = 1});
    const auto force =
        force_on(mesh, surface::NodeArray::Zero(mesh.n_nodes(), 3), 0, 0.01, [&](double x) { return gradient * x; });
    const double exact = -gradient * pi * 0.004 * 0.004 * 0.01;
    const double error = std::abs(force.col(0).sum() - exact);
    if (last_error > 0) {
      EXPECT_GT(last_error / error, 12);  // parabolas through a circle: fourth order, 16 in the limit
    }
    last_error = error;
    EXPECT_NEAR(force.col(1).sum(), 0, 1e-12 * std::abs(exact));
  }
}

TEST(PressureForce, PressureIsThatOfTheInletUpstreamAndOfTheExitDownstream) {
  const surface::SurfaceMesh mesh =
      make_surface({.outline = [](double t) { return Eigen::Vector2d(0.03 * t, 0.0); }, .n_across = 3, .n_rows = 1});
  // Faces end exactly at inlet and exit, so that the pressure is linear inside each of them.
  const auto force = force_on(mesh, surface::NodeArray::Zero(mesh.n_nodes(), 3), 0.01, 0.02,
                              [](double x) { return 1000 * (0.03 - x) / 0.01; });
  EXPECT_NEAR(force.col(1).sum(), -(2000 + 1500 + 1000) * 0.01 * 0.01, 1e-12);
}

TEST(PressureForce, FollowsTheRotatedSurface) {
  const surface::SurfaceMesh mesh =
      make_surface({.outline = [](double t) { return Eigen::Vector2d(0.01 * t, 0.003); }, .n_across = 2, .n_rows = 2});
  const double angle = 0.7;
  surface::NodeArray motion(mesh.n_nodes(), 3);
  for (std::int64_t i = 0; i < mesh.n_nodes(); ++i) {
    const double x = mesh.node_position(i, 0), y = mesh.node_position(i, 1);
    motion.row(i) << std::cos(angle) * x - std::sin(angle) * y - x, std::sin(angle) * x + std::cos(angle) * y - y, 0;
  }
  const auto force = force_on(mesh, motion, -1, 1, [](double) { return 800.0; });
  const double size = 800 * 0.01 * 0.01;
  EXPECT_NEAR(force.col(0).sum(), std::sin(angle) * size, 1e-13 * size);
  EXPECT_NEAR(force.col(1).sum(), -std::cos(angle) * size, 1e-13 * size);
}

TEST(PressureForce, MiddleNodesCarryTheirConsistentShare) {
  const surface::SurfaceMesh mesh =
      make_surface({.outline = [](double t) { return Eigen::Vector2d(0.01 * t, 0.0); }, .n_across = 1, .n_rows = 1});
  const auto force = force_on(mesh, surface::NodeArray::Zero(mesh.n_nodes(), 3), 0, 0.01, [](double) { return 1.0; });
  for (int i = 0; i < 8; ++i) {  // corners -1/12, middles 1/3 of the load
    EXPECT_NEAR(force(mesh.face_node[i], 1), -1e-4 * (i < 4 ? -1.0 / 12 : 1.0 / 3), 1e-18);
  }
}

}  // namespace
}  // namespace couplet::flow
