#include "solid-server/modal/modal_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/modal/mirror_symmetry.hpp"

namespace couplet::solid {
namespace {

const std::vector<BlockProperties> tissue = {{SaintVenantKirchhoff::from_young(15e3, 0.3), 1040, 8}};

FreeComponents held_at(const SolidMesh& mesh, const std::vector<std::string>& surfaces) {
  FreeComponents free = FreeComponents::Constant(mesh.n_nodes(), 3, true);
  for (const std::string& name : surfaces)
    for (const Index n : nodes_of_faces(mesh, mesh.find_surface(name, ""))) free.row(n).setConstant(false);
  return free;
}

NodeVectors at_rest(const SolidMesh& mesh) {
  return NodeVectors::Zero(mesh.n_nodes(), 4);
}

/// phi_m^T M phi_n, largest distance from the identity.
double orthonormality_error(const TangentSolver& solver, const std::vector<Mode>& modes) {
  double error = 0;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const NodeVectors momentum = solver.mass_times(modes[m].shape);
    for (std::size_t n = 0; n < modes.size(); ++n)
      error = std::max(error, std::abs(modes[n].shape.cwiseProduct(momentum).sum() - (m == n ? 1 : 0)));
  }
  return error;
}

TEST(ModalAnalysis, FindsTheShearAndPressureModesOfABar) {
  // Poisson's ratio 0: along the bar u = sin((2 k + 1) pi x / 2 L), omega = (2 k + 1) pi c / 2 L, held sideways by
  // symmetry so that only motion along it is left.
  SolidMesh mesh = make_box_mesh({{0.1, 0.01, 0.01}, {12, 1, 1}});
  FreeComponents free = held_at(mesh, {"x_min"});
  free.col(1).setConstant(false);
  free.col(2).setConstant(false);
  WorkTeam team(1);
  TangentSolver solver(mesh, {{SaintVenantKirchhoff::from_young(15e3, 0), 1040, 8}}, free, team);
  const auto modes = modal_analysis(solver, at_rest(mesh), 3);
  const double c = std::sqrt(15e3 / 1040);
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const double exact = (2.0 * static_cast<double>(k) + 1) * c / (4 * 0.1);
    // Quadratic elements: (h omega / c)^4 / 1440 of omega, 1e-4 for the third mode.
    EXPECT_NEAR(modes[k].frequency / exact, 1, 2e-4) << k;
    EXPECT_LE(modes[k].residual, 1e-8);
    EXPECT_NEAR(modes[k].direction_share[0], 1, 1e-12);
  }
}

TEST(ModalAnalysis, FindsEveryModeOfEqualPairsAndMakesThemOrthonormal) {
  // A square beam bends alike along y and z.
  const SolidMesh mesh = make_box_mesh({{1, 0.1, 0.1}, {10, 2, 2}});
  WorkTeam team(2);
  TangentSolver solver(mesh, tissue, held_at(mesh, {"x_min"}), team);
  for (const int n_modes : {3, 6}) {  // the first number parts a pair
    const auto modes = modal_analysis(solver, at_rest(mesh), n_modes);
    ASSERT_EQ(modes.size(), static_cast<std::size_t>(n_modes));
    EXPECT_NEAR(modes[0].frequency, modes[1].frequency, 1e-7 * modes[0].frequency);
    EXPECT_GT(modes[2].frequency, 5 * modes[0].frequency);
    EXPECT_LE(orthonormality_error(solver, modes), 1e-8);
    for (const Mode& mode : modes) {
      EXPECT_LE(mode.residual, 1e-6);
      EXPECT_NEAR(mode.direction_share[0] + mode.direction_share[1] + mode.direction_share[2], 1, 1e-12);
    }
  }
}

TEST(ModalAnalysis, FindsTheRigidMotionsOfAFreeBody) {
  const SolidMesh mesh = make_box_mesh({{0.1, 0.2, 0.3}, {2, 2, 3}});
  WorkTeam team(1);
  TangentSolver solver(mesh, tissue, held_at(mesh, {}), team);
  const auto modes = modal_analysis(solver, at_rest(mesh), 8);
  for (std::size_t n = 0; n < 6; ++n) EXPECT_LE(std::abs(modes[n].eigenvalue), 1e-6 * modes[6].eigenvalue) << n;
  EXPECT_GT(modes[6].frequency, 1);
  EXPECT_LE(orthonormality_error(solver, modes), 1e-8);
}

TEST(ModalAnalysis, HearsTensionAndBuckling) {
  // A thin bar held at both ends: stretched, it sounds higher; compressed far beyond Euler's load, it is not stable.
  const SolidMesh mesh = make_box_mesh({{1, 0.05, 0.04}, {10, 1, 1}});
  WorkTeam team(1);
  // A row of single elements is too soft with 8 points: some motions of their midside nodes cost no energy.
  TangentSolver solver(mesh, {{tissue[0].material, 1040, 14}}, held_at(mesh, {"x_min", "x_max"}), team);
  const auto frequency = [&](double strain) {
    NodeVectors displacement = at_rest(mesh);
    displacement.col(0) = strain * mesh.node_position.col(0);
    displacement.middleCols<2>(1) = -0.3 * strain * mesh.node_position.rightCols<2>();  // no stress across the bar
    return modal_analysis(solver, displacement, 1)[0].frequency;
  };
  const double at_rest = frequency(0);
  EXPECT_GT(frequency(0.02), 1.1 * at_rest);
  // Euler, clamped at both ends: strain 4 pi^2 I / (A L^2) = 4 pi^2 0.04^2 / 12 = 0.0053.
  EXPECT_GT(frequency(-0.004), 0);
  EXPECT_LT(frequency(-0.007), 0);
}

TEST(ModalAnalysis, RefusesMoreModesThanThereAre) {
  const SolidMesh mesh = make_box_mesh({{1, 1, 1}, {1, 1, 1}});
  WorkTeam team(1);
  TangentSolver solver(mesh, tissue, held_at(mesh, {"x_min"}), team);
  EXPECT_THROW(modal_analysis(solver, at_rest(mesh), 36), report::SceneError);
  EXPECT_THROW(modal_analysis(solver, at_rest(mesh), 0), report::SceneError);
  EXPECT_EQ(modal_analysis(solver, at_rest(mesh), 35).size(), 35u);
}

TEST(MirrorSymmetry, TellsSymmetricFromAntisymmetricModes) {
  const SolidMesh mesh = make_box_mesh({{1, 0.2, 0.1}, {8, 2, 1}});
  WorkTeam team(1);
  TangentSolver solver(mesh, tissue, held_at(mesh, {"x_min", "x_max"}), team);
  const auto modes = modal_analysis(solver, at_rest(mesh), 4);  // bending along z, along y; torsion; two waves along z
  const MirrorPlane across = middle_plane(mesh, 0), flat = middle_plane(mesh, 2);
  const auto mirrored = mirrored_nodes(mesh, across), turned = mirrored_nodes(mesh, flat);
  ASSERT_TRUE(mirrored && turned);
  EXPECT_DOUBLE_EQ(across.place, 0.5);
  EXPECT_EQ(symmetry_of(solver, modes[0], across, *mirrored), Symmetry::symmetric);
  EXPECT_EQ(symmetry_of(solver, modes[3], across, *mirrored), Symmetry::antisymmetric);
  EXPECT_EQ(symmetry_of(solver, modes[0], flat, *turned), Symmetry::antisymmetric);
  Mode mixed = modes[0];
  mixed.shape = (modes[0].shape + modes[3].shape) / std::sqrt(2.0);
  EXPECT_EQ(symmetry_of(solver, mixed, across, *mirrored), Symmetry::neither);
}

TEST(MirrorSymmetry, FindsNoImageInAMeshThatIsNotSymmetric) {
  SolidMesh mesh = make_box_mesh({{1, 1, 1}, {3, 3, 3}});
  ASSERT_TRUE(mirrored_nodes(mesh, middle_plane(mesh, 1)));
  EXPECT_FALSE(mirrored_nodes(mesh, {1, 0.4}));
  mesh.node_position(20, 1) += 1e-3;
  EXPECT_FALSE(mirrored_nodes(mesh, middle_plane(mesh, 1)));
}

}  // namespace
}  // namespace couplet::solid
