#include "solid-server/element/internal_force.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "proto/report/failure.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/element/tangent.hpp"
#include "solid-server/mesh/hex20_topology.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "tests/unit/solid-server/element/deformed_body.hpp"

namespace couplet::solid {
namespace {

const SaintVenantKirchhoff svk = SaintVenantKirchhoff::from_young(15e3, 0.475);
const MooneyRivlin rivlin = {2290, 250, 100e3};

/// 3 x 2 x 3 elements whose inner corner nodes are moved; edges stay straight, midside nodes in their middle.
SolidMesh distorted_patch() {
  SolidMesh mesh = make_box_mesh({{3, 2, 3}, {3, 2, 3}});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.15, 0.15);
  const NodePositions rest = mesh.node_position;
  const auto is_inside = [&](Index n) {
    return rest(n, 0) > 0.1 && rest(n, 0) < 2.9 && rest(n, 1) > 0.1 && rest(n, 1) < 1.9 && rest(n, 2) > 0.1 &&
           rest(n, 2) < 2.9;
  };
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (is_inside(n)) mesh.node_position.row(n) += Eigen::RowVector3d(shift(random), shift(random), shift(random));
  for (Index element = 0; element < mesh.n_elements(); ++element)
    for (const auto& face : hex20::face_node)
      for (std::size_t e = 0; e < 4; ++e) {
        const auto nodes = mesh.nodes_of(element);
        const auto corner = [&](std::size_t c) { return nodes[static_cast<std::size_t>(face[c % 4])]; };
        mesh.node_position.row(nodes[static_cast<std::size_t>(face[4 + e])]) =
            (mesh.node_position.row(corner(e)) + mesh.node_position.row(corner(e + 1))) / 2;
      }
  return mesh;
}

/// Moves midside nodes off the middle of their edges inside the patch.
SolidMesh curved_patch() {
  SolidMesh mesh = distorted_patch();
  std::vector<char> is_midside(static_cast<std::size_t>(mesh.n_nodes()), 0), is_outside = is_midside;
  for (Index element = 0; element < mesh.n_elements(); ++element)
    for (const Index node : mesh.nodes_of(element).subspan(8)) is_midside[static_cast<std::size_t>(node)] = 1;
  for (const auto& [name, faces] : mesh.surface)
    for (const Index n : nodes_of_faces(mesh, faces)) is_outside[static_cast<std::size_t>(n)] = 1;
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (is_midside[static_cast<std::size_t>(n)] && !is_outside[static_cast<std::size_t>(n)])
      mesh.node_position.row(n) += 0.05 * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
  return mesh;
}

TEST(InternalForce, PassesThePatchTestOnStraightEdgesWithAnyQuadrature) {
  for (const Material& material : {Material(svk), Material(rivlin)})
    for (const int n_points : {8, 14, 27})
      EXPECT_LE(patch_error(distorted_patch(), {material, 1000, n_points}), 1e-14) << n_points;  // round-off
}

TEST(InternalForce, PassesThePatchTestOnCurvedEdgesOnlyWithTwentySevenPoints) {
  EXPECT_LE(patch_error(curved_patch(), {rivlin, 1000, 27}), 1e-14);
  EXPECT_GE(patch_error(curved_patch(), {rivlin, 1000, 8}), 1e-6);
  EXPECT_GE(patch_error(curved_patch(), {rivlin, 1000, 14}), 1e-6);
}

class KernelOf : public testing::TestWithParam<int> {};

TEST_P(KernelOf, AgreesWithThePlainForm) {
  const int n_points = GetParam();
  const SolidMesh mesh = curved_patch();  // 18 elements: two packs and a part of one
  const NodeVectors displacement = wavy(mesh);
  for (const Material& material : {Material(svk), Material(rivlin)}) {
    const Forces fast = forces(mesh, {material, 1000, n_points}, displacement);
    NodePositions plain = NodePositions::Zero(mesh.n_nodes(), 3);
    double energy = 0;
    for (Index e = 0; e < mesh.n_elements(); ++e) {
      const auto nodes = mesh.nodes_of(e);
      const PlainElement element{material, ElementShape::hexahedron20, n_points, at_element(mesh.node_position, nodes)};
      const ElementVectors u = at_element(displacement, nodes), f = element_force(element, u);
      for (int a = 0; a < hex20::n_nodes; ++a) plain.row(nodes[static_cast<std::size_t>(a)]) += f.row(a);
      energy += element_energy(element, u);
    }
    EXPECT_LE((fast.at_node.leftCols<3>() - plain).cwiseAbs().maxCoeff(), 1e-12 * plain.cwiseAbs().maxCoeff());
    EXPECT_NEAR(fast.energy, energy, 1e-12 * energy);
  }
}

TEST_P(KernelOf, IsMinusTheDerivativeOfTheEnergy) {
  const int n_points = GetParam();
  const SolidMesh mesh = curved_patch();
  const NodeVectors displacement = wavy(mesh);
  const Forces at = forces(mesh, {rivlin, 1000, n_points}, displacement);
  NodeVectors direction = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) direction.row(n) << std::sin(5 * n), std::cos(7 * n), std::sin(11 * n), 0;
  const double h = 1e-5;
  const double slope = (forces(mesh, {rivlin, 1000, n_points}, displacement + h * direction).energy -
                        forces(mesh, {rivlin, 1000, n_points}, displacement - h * direction).energy) /
                       (2 * h);
  const double work = at.at_node.cwiseProduct(direction).sum();
  // Truncation: h^2 times the third derivative of the energy, which the bulk modulus makes some 1e3 times the slope.
  EXPECT_NEAR(slope, -work, 1e-6 * at.at_node.norm() * direction.norm());
}

TEST_P(KernelOf, FeelsNoRigidMotion) {
  const SolidMesh mesh = distorted_patch();
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  NodeVectors displacement = homogeneous(mesh, Q);
  displacement.leftCols<3>().rowwise() += Eigen::RowVector3d(0.3, -2, 5);
  for (const Material& material : {Material(svk), Material(rivlin)}) {
    const Forces at = forces(mesh, {material, 1000, GetParam()}, displacement);
    EXPECT_LE(at.at_node.cwiseAbs().maxCoeff(), 2e-9);  // round-off: 1e5 Pa, displacements of 5 m, some 20 terms
  }
}

INSTANTIATE_TEST_SUITE_P(Points, KernelOf, testing::Values(8, 14, 27));

TEST(InternalForce, NamesTheElementThatIsTurnedInsideOut) {
  const SolidMesh mesh = make_box_mesh({{20, 1, 1}, {20, 1, 1}});
  const ElementPacks packs = make_element_packs(mesh, mesh.block[0], 8);
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)  // the end of element 12 passes through it
    if (std::abs(mesh.node_position(n, 0) - 13) < 1e-9) displacement(n, 0) = -2.5;
  std::vector<StoredPack> buffer(static_cast<std::size_t>(packs.n_packs * packs.packs_of_force())), energy(3);
  for (const Material& material : {Material(svk), Material(rivlin)})
    EXPECT_EQ(
        internal_force(packs, material, 0, packs.n_packs, displacement.data(), buffer.data(), energy.data()).inverted,
        12);
}

// Twenty elements in a row, of which one to four are compressed to half of their length: below 1/sqrt(3).
TEST(InternalForce, CountsElementsThatHaveLostStiffness) {
  const SolidMesh mesh = make_box_mesh({{20, 1, 1}, {20, 1, 1}});
  for (const int n_points : {8, 14, 27}) {
    const ElementPacks packs = make_element_packs(mesh, mesh.block[0], n_points);
    std::vector<StoredPack> buffer(static_cast<std::size_t>(packs.n_packs * packs.packs_of_force())), energy(3);
    const auto findings = [&](int first, int n, const Material& material, bool with_energy) {
      NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
      for (Index node = 0; node < mesh.n_nodes(); ++node)
        displacement(node, 0) = -0.5 * std::clamp(mesh.node_position(node, 0) - first, 0.0, static_cast<double>(n));
      return internal_force(packs, material, 0, packs.n_packs, displacement.data(), buffer.data(),
                            with_energy ? energy.data() : nullptr);
    };
    EXPECT_EQ(findings(0, 0, svk, true).n_softened, 0);  // nor do the copies that fill up the last pack count
    EXPECT_EQ(findings(0, 0, svk, true).softened, -1);
    for (const int first : {0, 6, 16}) {
      EXPECT_EQ(findings(first, 4, svk, true).softened, first);
      EXPECT_EQ(findings(first, 4, svk, true).n_softened, 4);
      EXPECT_EQ(findings(first, 4, svk, true).inverted, -1);
    }
    EXPECT_EQ(findings(6, 4, svk, false).n_softened, 0);
    EXPECT_EQ(findings(6, 4, rivlin, true).n_softened, 0);
  }
}

TEST(ElementPacks, RefuseAnElementThatIsFoldedAtRest) {
  SolidMesh mesh = make_box_mesh({{2, 1, 1}, {2, 1, 1}});
  for (Index n = 0; n < mesh.n_nodes(); ++n)  // element 1 lies from x = 1 back to x = 0
    if (mesh.node_position(n, 0) > 1.1) mesh.node_position(n, 0) = 2 - mesh.node_position(n, 0);
  try {
    make_element_packs(mesh, mesh.block[0], 8);
    FAIL();
  } catch (const report::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("element 1 "), std::string::npos) << error.what();
  }
}

TEST(LumpedMass, GivesACubeTheSharesOfHinton) {
  const Eigen::VectorXd mass = lumped_mass(make_box_mesh({{1, 1, 1}, {1, 1, 1}}), {1000});
  EXPECT_NEAR(mass.sum(), 1000, 1e-9);
  EXPECT_NEAR(mass.minCoeff(), 28.2, 0.05);  // corners 0.0282, midside nodes 0.0645 of the mass
  EXPECT_NEAR(mass.maxCoeff(), 64.5, 0.05);
}

TEST(ElementTangent, IsMinusTheDerivativeOfTheForce) {
  const SolidMesh mesh = curved_patch();
  const ElementVectors X = at_element(mesh.node_position, mesh.nodes_of(4)),
                       u = at_element(wavy(mesh), mesh.nodes_of(4));
  const double h = 1e-6;
  for (const Material& material : {Material(svk), Material(rivlin)}) {
    const PlainElement element{material, ElementShape::hexahedron20, 14, X};
    const ElementTangent K = element_tangent(element, u);
    for (int column = 0; column < K.cols(); column += 7) {
      ElementVectors up = u, down = u;
      up(column / 3, column % 3) += h;
      down(column / 3, column % 3) -= h;
      const ElementVectors slope = (element_force(element, down) - element_force(element, up)) / (2 * h);
      for (int row = 0; row < K.rows(); ++row)
        EXPECT_NEAR(K(row, column), slope(row / 3, row % 3), 1e-7 * K.cwiseAbs().maxCoeff());
    }
  }
}

}  // namespace
}  // namespace couplet::solid
