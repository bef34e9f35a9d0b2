#include "solid-server/element/formulation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/tangent_solver.hpp"
#include "solid-server/dynamics/stable_step.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/element/shape_functions.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"
#include "tests/unit/solid-server/element/deformed_body.hpp"
#include "tests/unit/solid-server/element/element_cases.hpp"
#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"
#include "tests/unit/solid-server/material/material_examples.hpp"

namespace couplet::solid {
namespace {

using Formulation = ElementFormulation;

std::vector<Material> laws_of(const Case& c) {
  std::vector<Material> laws = {example<NeoHookean>(), example<MooneyRivlin>(), example<HolzapfelGasserOgden>()};
  if (c.formulation != Formulation::near_incompressible) laws.push_back(example<SaintVenantKirchhoff>());
  return laws;
}

/// Fibres that turn from element to element would feel different strains in the patch test: all have the same.
void give_axes(SolidMesh& mesh) {
  for (ElementBlock& block : mesh.block)
    block.axes.assign(static_cast<std::size_t>(block.n_elements()),
                      {Eigen::Vector3d(0.6, 0.8, 0), Eigen::Vector3d(-0.8, 0.6, 0)});
}

NodeVectors scattered(const SolidMesh& mesh) {
  NodeVectors direction = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) direction.row(n) << std::sin(5 * n), std::cos(7 * n), std::sin(11 * n), 0;
  return direction;
}

class Element : public testing::TestWithParam<Case> {
 protected:
  BlockProperties properties(const Material& material) const {
    return {material, 1000, GetParam().n_points, GetParam().formulation};
  }
  SolidMesh patch() const {
    SolidMesh mesh = distorted_patch_of(GetParam().shape);
    give_axes(mesh);
    return mesh;
  }
};

TEST_P(Element, PassesThePatchTestOnDistortedMeshes) {
  for (const Material& material : laws_of(GetParam()))
    EXPECT_LE(patch_error(patch(), properties(material)), 1e-14);  // round-off
}

TEST_P(Element, HasTheEnergyOfTheLawInAHomogeneousState) {
  const double volume = 3 * 2 * 3 * Eigen::Matrix3d{{1, 0.3, 0}, {0, 1, -0.2}, {0.1, 0, 0.9}}.determinant();
  const SolidMesh mesh = patch();
  for (const Material& material : laws_of(GetParam())) {
    const LocalAxes<double> axes{{{0.6, 0.8, 0}, {-0.8, 0.6, 0}}};
    const double W = std::visit([&](const auto& law) { return energy_of(law, tensor(stretched), axes); }, material);
    const double energy = forces(mesh, properties(material), homogeneous(mesh, stretched)).energy;
    EXPECT_NEAR(energy, W * volume, 1e-12 * energy);
  }
}

TEST_P(Element, HasForcesThatAreMinusTheDerivativeOfTheEnergy) {
  const SolidMesh mesh = patch();
  const NodeVectors u = wavy(mesh), direction = scattered(mesh);
  const double h = 1e-5;
  for (const Material& material : laws_of(GetParam())) {
    const NodeVectors force = forces(mesh, properties(material), u).at_node;
    const double slope = (forces(mesh, properties(material), u + h * direction).energy -
                          forces(mesh, properties(material), u - h * direction).energy) /
                         (2 * h);
    // Truncation: h^2 times the third derivative of the energy, which the bulk modulus makes some 1e3 times the slope.
    EXPECT_NEAR(slope, -force.cwiseProduct(direction).sum(), 1e-6 * force.norm() * direction.norm());
  }
}

TEST_P(Element, HasATangentThatIsMinusTheDerivativeOfTheForce) {
  const SolidMesh mesh = patch();
  // Stretched all over: where fibres begin to carry the tangent jumps.
  const NodeVectors u = wavy(mesh) + homogeneous(mesh, 1.3 * Eigen::Matrix3d::Identity()), direction = scattered(mesh);
  const double h = 1e-6;
  WorkTeam team(1);
  const FreeComponents free = FreeComponents::Constant(mesh.n_nodes(), 3, true);
  for (const Material& material : laws_of(GetParam())) {
    TangentSolver solver(mesh, {properties(material)}, free, team);
    EXPECT_EQ(solver.assemble(u, {}), -1);
    const NodeVectors product = solver.multiply(direction);
    const NodeVectors slope = (forces(mesh, properties(material), u - h * direction).at_node -
                               forces(mesh, properties(material), u + h * direction).at_node) /
                              (2 * h);
    // Truncation h^2 times ratios of 1e4 of the derivatives of forces; round-off 1e-16 / h.
    EXPECT_LE((product - slope).cwiseAbs().maxCoeff(), 1e-7 * product.cwiseAbs().maxCoeff());
  }
}

TEST_P(Element, TakesTheStressOfAnIncrementAsTheStandardFormulationDoes) {
  // In a homogeneous state formulations differ in directions that are not homogeneous only.
  const SolidMesh mesh = patch();
  const Eigen::Matrix3d step{{0.1, -0.4, 0.1}, {0.5, 0.05, 0.2}, {-0.1, -0.2, 0.1}};
  const NodeVectors u = homogeneous(mesh, stretched), d = homogeneous(mesh, Eigen::Matrix3d::Identity() + step),
                    direction = homogeneous(mesh, stretched.transpose());
  WorkTeam team(1);
  const FreeComponents free = FreeComponents::Constant(mesh.n_nodes(), 3, true);
  for (const Material& material : laws_of(GetParam())) {
    TangentSolver solver(mesh, {properties(material)}, free, team);
    const int n_points = GetParam().formulation == Formulation::stabilised ? 8 : GetParam().n_points;
    TangentSolver standard(mesh, {{material, 1000, n_points}}, free, team);
    solver.assemble(u, {}, &d);
    standard.assemble(u, {}, &d);
    const NodeVectors expected = standard.multiply(direction);
    EXPECT_LE((solver.multiply(direction) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_P(Element, FeelsNoRigidMotion) {
  const SolidMesh mesh = patch();
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  NodeVectors moved = homogeneous(mesh, Q);
  moved.leftCols<3>().rowwise() += Eigen::RowVector3d(0.3, -2, 5);
  NodeVectors deformed_and_moved = wavy(mesh);
  const NodePositions x = mesh.node_position + deformed_and_moved.leftCols<3>();
  deformed_and_moved.leftCols<3>() = x * Q.transpose() - mesh.node_position;
  for (const Material& material : laws_of(GetParam())) {
    const BlockProperties p = properties(material);
    EXPECT_LE(forces(mesh, p, moved).at_node.cwiseAbs().maxCoeff(), 5e-9);  // round-off: 1e5 Pa, 5 m, some 20 terms
    const Forces here = forces(mesh, p, wavy(mesh)), there = forces(mesh, p, deformed_and_moved);
    EXPECT_NEAR(there.energy, here.energy, 1e-12 * here.energy);
    const NodePositions turned = here.at_node.leftCols<3>() * Q.transpose();
    EXPECT_LE((there.at_node.leftCols<3>() - turned).cwiseAbs().maxCoeff(), 1e-11 * turned.cwiseAbs().maxCoeff());
  }
}

TEST_P(Element, GivesItsForcesWithoutEnergyToo) {
  const SolidMesh mesh = patch();
  for (const Material& material : laws_of(GetParam())) {
    NodalForce body(mesh, {properties(material)}, ExternalForce(mesh, {}, {}, {}), 1);
    const NodeVectors with = body.all(wavy(mesh), {0, 0, true}), without = body.all(wavy(mesh), {0, 0, false});
    EXPECT_LE((with - without).cwiseAbs().maxCoeff(), 1e-13 * with.cwiseAbs().maxCoeff());  // order of operations
  }
}

TEST_P(Element, HasAStableStepFromItsHighestFrequency) {
  const SolidMesh mesh = patch();
  const BlockProperties p = properties(example<NeoHookean>());
  const Eigen::VectorXd mass = lumped_mass(mesh, {p.density});
  NodeVectors inverse_mass = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (int i = 0; i < 3; ++i) inverse_mass.col(i) = mass.cwiseInverse();
  const NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  NodalForce body(mesh, {p}, ExternalForce(mesh, {}, {}, {}), 1);
  WorkTeam team(1);
  const double step =
      stable_step([&](const NodeVectors& at, NodeVectors& force) { body.internal_only(at, team, force); }, u,
                  inverse_mass, 0.3, 0, team);

  TangentSolver solver(mesh, {p}, FreeComponents::Constant(mesh.n_nodes(), 3, true), team);
  solver.assemble(u, {});
  NodeVectors mode = scattered(mesh);
  double rate_squared = 0;
  for (int n = 0; n < 400; ++n) {
    mode /= std::sqrt(mode.cwiseAbs2().cwiseQuotient(inverse_mass.cwiseMax(1e-300)).leftCols<3>().sum());
    const NodeVectors force = solver.multiply(mode);
    rate_squared = mode.cwiseProduct(force).sum();  // Rayleigh's quotient: from below
    mode = force.cwiseProduct(inverse_mass);
  }
  EXPECT_LE(step, 2 / std::sqrt(rate_squared));
  EXPECT_GE(step, 0.97 * 2 / std::sqrt(rate_squared));  // both iterations are a few per cent from the end at most
}

TEST_P(Element, NamesTheOneThatIsTurnedInsideOut) {
  const Case c = GetParam();
  const SolidMesh mesh = in_shape(make_box_mesh({{20, 1, 1}, {20, 1, 1}}), c.shape);
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)  // the end of hexahedron 12 passes through it
    if (std::abs(mesh.node_position(n, 0) - 13) < 1e-9) displacement(n, 0) = -2.5;
  const Index expected = c.shape == ElementShape::tetrahedron10 ? 12 * 6 : 12;  // six tetrahedra in a hexahedron
  WorkTeam team(1);
  NodalForce body(mesh, {properties(example<NeoHookean>())}, ExternalForce(mesh, {}, {}, {}), 1);
  body.all(displacement, {0, 0, false});
  EXPECT_EQ(body.inverted_element(), expected);
  TangentSolver solver(mesh, {properties(example<NeoHookean>())}, FreeComponents::Constant(mesh.n_nodes(), 3, true),
                       team);
  EXPECT_EQ(solver.assemble(displacement, {}), expected);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Element, testing::ValuesIn(cases),
                         [](const auto& test) { return std::string(test.param.name); });

/// Ways to deform a box of elements that cost no energy, besides the six rigid motions.
int n_free_modes(const Case& c, const std::array<int, 3>& n_elements) {
  const SolidMesh mesh = in_shape(make_box_mesh({{1, 1.3, 0.8}, n_elements}), c.shape);
  WorkTeam team(1);
  TangentSolver solver(mesh, {{example<NeoHookean>(), 1000, c.n_points, c.formulation}},
                       FreeComponents::Constant(mesh.n_nodes(), 3, true), team);
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {});
  const Eigen::Index n = 3 * mesh.n_nodes();
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index column = 0; column < n; ++column) {
    NodeVectors unit = NodeVectors::Zero(mesh.n_nodes(), 4);
    unit(column / 3, column % 3) = 1;
    const NodeVectors f = solver.multiply(unit);
    for (Eigen::Index row = 0; row < n; ++row) K(row, column) = f(row / 3, row % 3);
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GE(values[0], -1e-12 * values[n - 1]);
  return static_cast<int>((values.array() < 1e-10 * values[n - 1]).count()) - 6;
}

TEST(ElementRank, IsFullButForEightPointsInSingleRows) {
  for (const Case& c : cases) {
    const bool is_weak = c.shape == ElementShape::hexahedron20 && c.n_points == 8;
    const bool is_near_incompressible = c.formulation == Formulation::near_incompressible;
    EXPECT_EQ(n_free_modes(c, {1, 1, 1}), is_weak ? is_near_incompressible ? 10 : 6 : 0) << c.name;
    EXPECT_EQ(n_free_modes(c, {3, 1, 1}), is_weak ? 4 : 0) << c.name;
    EXPECT_EQ(n_free_modes(c, {2, 2, 1}), 0) << c.name;
  }
}

TEST(DefaultPoints, SuitTheMesh) {
  const auto n_points = [](const SolidMesh& mesh, Formulation formulation) {
    return default_n_points(mesh, mesh.block[0], formulation);
  };
  const SolidMesh sheet = make_box_mesh({{1, 1, 1}, {3, 2, 1}}), row = make_box_mesh({{1, 1, 1}, {3, 1, 1}});
  EXPECT_EQ(n_points(sheet, Formulation::standard), 8);
  EXPECT_EQ(n_points(row, Formulation::standard), 14);
  EXPECT_EQ(n_points(row, Formulation::near_incompressible), 14);
  EXPECT_EQ(n_points(curved_patch_of(ElementShape::hexahedron20, 0.01), Formulation::standard), 8);
  EXPECT_EQ(n_points(curved_patch_of(ElementShape::hexahedron20, 0.1), Formulation::standard), 27);
  EXPECT_EQ(n_points(in_shape(row, ElementShape::tetrahedron10), Formulation::standard), 4);
  EXPECT_EQ(n_points(in_shape(row, ElementShape::hexahedron8), Formulation::stabilised), 1);
  EXPECT_EQ(n_points(in_shape(row, ElementShape::hexahedron8), Formulation::standard), 8);
}

TEST(DefaultFormulation, IsStabilisedForEightNodes) {
  EXPECT_EQ(default_formulation(ElementShape::hexahedron8), Formulation::stabilised);
  EXPECT_EQ(default_formulation(ElementShape::hexahedron20), Formulation::standard);
  EXPECT_EQ(default_formulation(ElementShape::tetrahedron10), Formulation::standard);
}

TEST(CheckFormulation, RefusesWhatThereIsNotAndSaysWhere) {
  const auto complaint = [](ElementShape shape, Formulation formulation, const Material& material) {
    try {
      check_formulation("solid.body[2].elements", shape, formulation, material);
    } catch (const report::SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Material svk = example<SaintVenantKirchhoff>(), neo_hooke = example<NeoHookean>();
  for (const Case& c : cases) EXPECT_EQ(complaint(c.shape, c.formulation, neo_hooke), "") << c.name;
  const std::string no_split = complaint(ElementShape::hexahedron20, Formulation::near_incompressible, svk);
  EXPECT_NE(no_split.find("solid.body[2].elements"), std::string::npos) << no_split;
  EXPECT_NE(no_split.find("Saint Venant-Kirchhoff"), std::string::npos) << no_split;
  EXPECT_NE(complaint(ElementShape::hexahedron8, Formulation::near_incompressible, neo_hooke), "");
  EXPECT_NE(complaint(ElementShape::hexahedron20, Formulation::stabilised, neo_hooke), "");
}

TEST(StabilisedHexahedron, RefusesACornerThatIsFoldedAtRest) {
  SolidMesh mesh = in_shape(make_box_mesh({{1, 1, 1}, {1, 1, 1}}), ElementShape::hexahedron8);
  mesh.node_position.row(mesh.block[0].node[6]) << 0.1, 0.1, 0.1;  // of (1, 1, 1): the volume stays above 0
  EXPECT_THROW(make_element_packs(mesh, mesh.block[0], 1, Formulation::stabilised), report::SceneError);
}

class Shape : public testing::TestWithParam<ElementShape> {};

TEST_P(Shape, FunctionsAreAPartitionOfUnityAndReproduceLinearFields) {
  const ElementTopology& t = topology(GetParam());
  for (const QuadraturePoint& point : element_quadrature(GetParam(), n_mass_points(GetParam()))) {
    const auto N = shape_values(GetParam(), point.xi);
    const auto slope = shape_gradient(GetParam(), point.xi);
    EXPECT_NEAR(N.sum(), 1, 1e-14);
    EXPECT_LE(slope.colwise().sum().norm(), 1e-14);
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int a = 0; a < t.n_nodes; ++a) {
      const Eigen::Vector3d at(t.coordinate[static_cast<std::size_t>(a)].data());
      x += N[a] * at;
      gradient += at * slope.row(a);
    }
    EXPECT_LE((x - point.xi).norm(), 1e-14);
    EXPECT_LE((gradient - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  }
}

TEST_P(Shape, MassIsPositiveAndAddsUp) {
  const SolidMesh mesh = distorted_patch_of(GetParam());
  const Eigen::VectorXd mass = lumped_mass(mesh, {1000});
  const double volume = 18 * Eigen::Matrix3d{{1, 0.3, 0}, {0, 1, -0.2}, {0.1, 0, 0.9}}.determinant();
  EXPECT_GT(mass.minCoeff(), 0);
  EXPECT_NEAR(mass.sum(), 1000 * volume, 1e-12 * 1000 * volume);
}

INSTANTIATE_TEST_SUITE_P(All, Shape,
                         testing::Values(ElementShape::hexahedron20, ElementShape::hexahedron8,
                                         ElementShape::tetrahedron10));

TEST(CurvedEdges, CostLittleUpToTheLimitOfHasCurvedEdges) {
  for (const Case& c : cases) {
    if (c.shape == ElementShape::hexahedron8) continue;
    const double error =
        patch_error(curved_patch_of(c.shape, 0.05), {example<NeoHookean>(), 1000, c.n_points, c.formulation});
    if (c.n_points == 27)
      EXPECT_LE(error, 1e-14) << c.name;  // round-off
    else
      EXPECT_LE(error, c.n_points == 14 ? 3e-4 : 4e-5) << c.name;  // as measured; in a strain of 0.3
  }
}

}  // namespace
}  // namespace couplet::solid
