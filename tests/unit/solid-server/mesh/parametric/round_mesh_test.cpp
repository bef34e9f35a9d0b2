// Annulus, hollow sphere, ball and arch: volumes and areas against their formulas, with the order of elements whose
// midside nodes stand on the curve.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/element_quality.hpp"
#include "solid-server/mesh/parametric/annulus_mesh.hpp"
#include "solid-server/mesh/parametric/arch_mesh.hpp"
#include "solid-server/mesh/parametric/ball_mesh.hpp"
#include "solid-server/mesh/parametric/hollow_sphere_mesh.hpp"
#include "tests/unit/solid-server/mesh/mesh_measures.hpp"

namespace couplet::solid {
namespace {

using std::numbers::pi;

/// Quadratic edges through points of a smooth curve leave errors of fourth order in area and volume.
void expect_fourth_order(const std::function<double(int)>& measured, double exact, int n_coarse) {
  const double coarse = std::abs(measured(n_coarse) / exact - 1), fine = std::abs(measured(2 * n_coarse) / exact - 1);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.4) << coarse << " " << fine;
}

std::size_t n_named_faces(const SolidMesh& mesh) {
  std::size_t n = 0;
  for (const auto& surface : mesh.surface) n += surface.second.size();
  return n;
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(AnnulusMesh, HasVolumeAndAreasOfTheCylinder) {
  for (const double angle : {pi / 2, pi, 2 * pi}) {
    const auto annulus = [&](int n) {
      return make_annulus_mesh({1, 2, 3, angle, {2, n * static_cast<int>(std::lround(angle / (pi / 2))), 2}});
    };
    expect_fourth_order([&](int n) { return volume_of(annulus(n)); }, angle / 2 * 3 * 3, 2);
    expect_fourth_order([&](int n) { return area_of(annulus(n), "inner"); }, angle * 3, 2);
    const SolidMesh mesh = annulus(3);
    EXPECT_NO_THROW(check_mesh(mesh, "annulus"));
    EXPECT_EQ(find_parts(mesh).first_element.size(), 1u);
    EXPECT_EQ(n_named_faces(mesh), n_boundary_faces(mesh));
    for (const Index node : mesh.find_nodes("outer", ""))
      EXPECT_NEAR(mesh.node_position.row(node).head<2>().norm(), 2, 1e-14);
    EXPECT_EQ(mesh.surface.contains("start"), angle < 6);
  }
  const SolidMesh quarter = make_annulus_mesh({1, 2, 1, pi / 2, {1, 2, 1}});
  for (const Index node : quarter.find_nodes("start", "")) EXPECT_NEAR(quarter.node_position(node, 1), 0, 1e-15);
  for (const Index node : quarter.find_nodes("end", "")) EXPECT_NEAR(quarter.node_position(node, 0), 0, 1e-15);
}

TEST(AnnulusMesh, RefusesWhatDoesNotFit) {
  EXPECT_EQ(refusal([] {
              make_annulus_mesh({2, 1, 1, pi, {1, 4, 1}});
            }),
            "annulus: inner_radius of 2 m is not between 0 and outer_radius of 1 m");
  EXPECT_EQ(refusal([] {
              make_annulus_mesh({1, 2, 1, 2 * pi, {1, 3, 1}});
            }),
            "annulus: 3 elements around are too few for 360 degrees; give at least one for each quarter turn");
  EXPECT_EQ(refusal([] {
              make_annulus_mesh({1, 2, 1, 7, {1, 9, 1}});
            }),
            "annulus: angle of 401.07 degrees is not above 0 and at most 360");
}

TEST(HollowSphereMesh, HasVolumeAndAreasOfTheSphere) {
  const auto sphere = [](int n) { return make_hollow_sphere_mesh({1, 2, n, n}); };
  expect_fourth_order([&](int n) { return volume_of(sphere(n)); }, 4 * pi / 3 * (8 - 1) / 8, 2);
  expect_fourth_order([&](int n) { return area_of(sphere(n), "outer"); }, 4 * pi * 4 / 8, 2);
  const SolidMesh mesh = sphere(3);
  EXPECT_NO_THROW(check_mesh(mesh, "sphere"));
  EXPECT_EQ(mesh.n_elements(), 3 * 27);
  EXPECT_EQ(n_named_faces(mesh), n_boundary_faces(mesh));
  EXPECT_GT(smallest_scaled_jacobian(mesh),
            0.8);  // sin(120 deg) on the diagonal, a little less by the size of elements
  const char* const planes[] = {"x_min", "y_min", "z_min"};
  for (int k = 0; k < 3; ++k)
    for (const Index node : mesh.find_nodes(planes[k], "")) EXPECT_NEAR(mesh.node_position(node, k), 0, 1e-15);
  for (const Index node : mesh.find_nodes("inner", "")) EXPECT_NEAR(mesh.node_position.row(node).norm(), 1, 1e-14);
  EXPECT_EQ(refusal([] {
              make_hollow_sphere_mesh({0, 1, 1, 1});
            }),
            "hollow_sphere: inner_radius of 0 m is not between 0 and outer_radius of 1 m");
}

struct BallCase {
  BallPart part;
  bool is_quarter;
  double share;  // of the ball
};

TEST(BallMesh, HasVolumeAndAreaOfTheBall) {
  for (const BallCase& ball : {BallCase{BallPart::whole, false, 1}, BallCase{BallPart::lower_half, false, 0.5},
                               BallCase{BallPart::upper_half, true, 0.125}, BallCase{BallPart::lower_half, true, 0.125},
                               BallCase{BallPart::whole, true, 0.25}}) {
    const auto make = [&](int n) {
      return make_ball_mesh(
          {.radius = 2, .centre = {3, 4, 5}, .part = ball.part, .is_quarter = ball.is_quarter, .n_elements = n});
    };
    expect_fourth_order([&](int n) { return volume_of(make(n)); }, ball.share * 4 * pi / 3 * 8, 2);
    expect_fourth_order([&](int n) { return area_of(make(n), "surface"); }, ball.share * 4 * pi * 4, 2);
    const SolidMesh mesh = make(2);
    EXPECT_NO_THROW(check_mesh(mesh, "ball"));
    EXPECT_EQ(find_parts(mesh).first_element.size(), 1u);
    EXPECT_EQ(mesh.n_elements(), std::lround(ball.share * 32 * 8));
    EXPECT_EQ(n_named_faces(mesh), n_boundary_faces(mesh));
    EXPECT_GT(smallest_scaled_jacobian(mesh), 0.4);  // 0.57 would be three edges at 120 degrees in space
    for (const Index node : mesh.find_nodes("surface", ""))
      EXPECT_NEAR((mesh.node_position.row(node) - Eigen::RowVector3d(3, 4, 5)).norm(), 2, 1e-14);
    if (ball.part != BallPart::whole) {
      for (const Index node : mesh.find_nodes("cut", "")) EXPECT_NEAR(mesh.node_position(node, 1), 4, 1e-15);
      EXPECT_EQ(mesh.node_position.col(1).mean() < 4, ball.part == BallPart::lower_half);
    }
    if (ball.is_quarter) {
      for (const Index node : mesh.find_nodes("z_min", "")) EXPECT_NEAR(mesh.node_position(node, 2), 5, 1e-15);
    }
  }
  EXPECT_EQ(refusal([] { make_ball_mesh({.radius = -1}); }), "ball: radius of -1 m is not above 0");
}

TEST(ArchMesh, HasTheVolumeOfLineTimesThickness) {
  const ArchShape fine{.span = 1, .rise = 0.2, .thickness = 0.1, .width = 0.5, .n_elements = {400, 1, 1}};
  double length = 0;  // of the middle line
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) length += std::hypot(1, 0.2 * pi * std::cos(pi * (i + 0.5) / n)) / n;
  // Equal parts to both sides of the middle line: a strip's area is length times thickness.
  EXPECT_NEAR(volume_of(make_arch_mesh(fine)) / (length * 0.1 * 0.5), 1, 1e-8);
  for (const std::array<int, 3>& counts : {std::array{6, 1, 1}, std::array{7, 2, 1}, std::array{5, 3, 2}}) {
    ArchShape shape = fine;
    shape.n_elements = counts;
    const SolidMesh mesh = make_arch_mesh(shape);
    EXPECT_NO_THROW(check_mesh(mesh, "arch"));
    EXPECT_EQ(n_named_faces(mesh), n_boundary_faces(mesh));
    EXPECT_LE((mesh.node_position.row(mesh.marker.at("crown")) - Eigen::RowVector3d(0.5, 0.25, 0)).norm(), 1e-15);
    for (const Index node : mesh.find_nodes("right_hinge", ""))
      EXPECT_LE((mesh.node_position.row(node).head<2>() - Eigen::RowVector2d(1, 0)).norm(), 1e-15);
    EXPECT_GE(mesh.find_nodes("left_hinge", "").size(), 2u);
  }
  ArchShape thick = fine;
  thick.thickness = 1.1;
  EXPECT_EQ(refusal([&] { make_arch_mesh(thick); }),
            "arch: thickness of 1.1 m is not below twice the radius of the crown, 1.01321 m; choose a thinner or "
            "flatter arch");
}

}  // namespace
}  // namespace couplet::solid
