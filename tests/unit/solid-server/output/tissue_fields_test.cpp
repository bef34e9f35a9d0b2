#include "solid-server/output/tissue_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/element/point_state.hpp"
#include "tests/unit/solid-server/element/element_cases.hpp"
#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"
#include "tests/unit/solid-server/material/material_examples.hpp"

namespace couplet::solid {
namespace {

using Formulation = ElementFormulation;

const std::vector<TissueField> all_fields = {TissueField::cauchy_stress,    TissueField::largest_principal_stress,
                                             TissueField::von_mises_stress, TissueField::volume_ratio,
                                             TissueField::fibre_stretch,    TissueField::fibre_direction};

std::vector<Material> laws_of(const Case& c) {
  std::vector<Material> laws = {example<NeoHookean>(), example<MooneyRivlin>(), example<HolzapfelGasserOgden>(),
                                example<MayNewman>()};
  if (c.formulation != Formulation::near_incompressible) laws.push_back(example<SaintVenantKirchhoff>());
  return laws;
}

const Matrix axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();

SolidMesh patch_of(ElementShape shape) {
  SolidMesh mesh = distorted_patch_of(shape);
  for (ElementBlock& block : mesh.block)
    block.axes.assign(static_cast<std::size_t>(block.n_elements()), {axes.col(0), axes.col(1)});
  return mesh;
}

/// The patch in the state x = F X with an axis-free `wave` beside it.
NodeVectors moved(const SolidMesh& mesh, const Matrix& F, double wave = 0) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d X = mesh.node_position.row(n);
    const Eigen::Vector3d ripple(std::sin(X.y() + X.z()), std::cos(X.x() - X.z()), std::sin(X.x() * X.y()));
    displacement.row(n).head<3>() = F * (X + wave * ripple) - X;
  }
  return displacement;
}

const surface::NodeArray& values(const surface::FieldSet& fields, const std::string& name) {
  return surface::find_field(fields, name).values;
}

Matrix stress_at(const TissueState& state, Eigen::Index node) {
  return values(state.at_nodes, "cauchy_stress").row(node).reshaped<Eigen::RowMajor>(3, 3);
}

class TissueFieldsOf : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Elements, TissueFieldsOf, testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST_P(TissueFieldsOf, AreExactInHomogeneousStatesOfEveryLaw) {
  const SolidMesh mesh = patch_of(GetParam().shape);
  const Matrix F{{1.2, 0.15, -0.1}, {0.05, 0.9, 0.2}, {-0.1, 0.1, 1.05}};
  const double J = F.determinant();
  for (const Material& law : laws_of(GetParam())) {
    const std::vector<BlockProperties> properties = {{law, 1000, GetParam().n_points, GetParam().formulation}};
    const bool has_fibres = std::visit([](const auto& l) { return l.is_anisotropic; }, law);
    const TissueFields fields(mesh, properties,
                              has_fibres ? all_fields : std::vector(all_fields.begin(), all_fields.begin() + 4));
    const TissueState state = fields.at(moved(mesh, F));
    const Matrix P = std::visit([&](const auto& l) { return matrix(stress_of(l, tensor(F), axes_of(axes))); }, law);
    const Matrix cauchy = P * F.transpose() / J;
    const Matrix deviator = cauchy - cauchy.trace() / 3 * Matrix::Identity();
    Eigen::SelfAdjointEigenSolver<Matrix> principal;
    principal.computeDirect(cauchy, Eigen::EigenvaluesOnly);  // roots of the characteristic polynomial
    const double scale = 1e5;  // [Pa] of the bulk modulus: round-off of J is multiplied by it
    for (Index n = 0; n < mesh.n_nodes(); ++n) {
      ASSERT_LE((stress_at(state, n) - cauchy).norm(), 1e-11 * scale) << law.index() << ' ' << n;
      ASSERT_NEAR(values(state.at_nodes, "volume_ratio")(n, 0), J, 1e-12);
      ASSERT_NEAR(values(state.at_nodes, "von_mises_stress")(n, 0), std::sqrt(1.5 * deviator.squaredNorm()),
                  1e-10 * scale);
      ASSERT_NEAR(values(state.at_nodes, "largest_principal_stress")(n, 0), principal.eigenvalues()[2], 1e-10 * scale);
    }
    if (!has_fibres) continue;
    const double angle = law.index() == 3 ? 0.5 : 0;  // holzapfel_gasser_ogden of the examples, may_newman
    const Eigen::Vector3d along = F * (std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1));
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      ASSERT_NEAR(values(state.at_nodes, "fibre_stretch")(n, 0), along.norm(), 1e-12);
    for (Index e = 0; e < mesh.n_elements(); ++e)
      ASSERT_LE((values(state.of_elements, "fibre_direction").row(e).transpose() - along.normalized()).norm(), 1e-12);
  }
}

TEST_P(TissueFieldsOf, TurnWithTheBody) {
  const SolidMesh mesh = patch_of(GetParam().shape);
  const Matrix F{{1.1, 0.1, 0}, {0, 0.95, 0.1}, {0.05, 0, 1.02}};
  const Matrix Q = Eigen::AngleAxisd(2.1, Eigen::Vector3d(-1, 0.5, 2).normalized()).toRotationMatrix();
  const std::vector<BlockProperties> properties = {
      {example<HolzapfelGasserOgden>(), 1000, GetParam().n_points, GetParam().formulation}};
  const TissueFields fields(mesh, properties, all_fields);
  const TissueState before = fields.at(moved(mesh, F, 0.05));
  NodeVectors turned = NodeVectors::Zero(mesh.n_nodes(), 4);
  turned.leftCols<3>() = (mesh.node_position + moved(mesh, F, 0.05).leftCols<3>()) * Q.transpose() - mesh.node_position;
  const TissueState after = fields.at(turned);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    ASSERT_LE((stress_at(after, n) - Q * stress_at(before, n) * Q.transpose()).norm(), 1e-11 * 1e5) << n;
  for (const char* const name : {"largest_principal_stress", "von_mises_stress"})
    EXPECT_LE((values(after.at_nodes, name) - values(before.at_nodes, name)).cwiseAbs().maxCoeff(), 1e-10 * 1e5);
  for (const char* const name : {"volume_ratio", "fibre_stretch"})
    EXPECT_LE((values(after.at_nodes, name) - values(before.at_nodes, name)).cwiseAbs().maxCoeff(), 1e-12);
  const surface::NodeArray direction = values(before.of_elements, "fibre_direction") * Q.transpose();
  EXPECT_LE((values(after.of_elements, "fibre_direction") - direction).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(TissueFieldsOf, CarryLinearFunctionsExactlyFromPointsToNodes) {
  const auto& t = topology(GetParam().shape);
  const Eigen::MatrixXd to_nodes = points_to_nodes(GetParam().shape, GetParam().n_points);
  const auto points = element_quadrature(GetParam().shape, GetParam().n_points);
  const Eigen::Vector3d slope = GetParam().n_points == 1 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(2, -3, 0.5);
  Eigen::VectorXd at_points(GetParam().n_points);
  for (std::size_t q = 0; q < points.size(); ++q) at_points[static_cast<Eigen::Index>(q)] = 1 + slope.dot(points[q].xi);
  const Eigen::VectorXd at_nodes = to_nodes * at_points;
  for (std::size_t a = 0; a < static_cast<std::size_t>(t.n_nodes); ++a)
    EXPECT_NEAR(at_nodes[static_cast<Eigen::Index>(a)], 1 + slope.dot(Eigen::Vector3d(t.coordinate[a].data())), 1e-13);
}

/// Two unit cubes in a row, of two regions: the second three times as stiff.
struct TwoRegions {
  SolidMesh mesh = make_box_mesh({{2, 1, 1}, {2, 1, 1}});
  std::vector<BlockProperties> properties = {{NeoHookean{1000, 5000}, 1000}, {NeoHookean{3000, 15000}, 1000}};

  TwoRegions() {
    ElementBlock first = mesh.block[0], second = first;
    first.node.resize(20);
    second.node.erase(second.node.begin(), second.node.begin() + 20);
    first.region = "soft", second.region = "stiff";
    second.first_element = 1;
    mesh.block = {first, second};
  }
};

TEST(RegionNodes, HaveACopyWhereRegionsMeet) {
  const TwoRegions body;
  const RegionNodes nodes = nodes_by_region(body.mesh);
  EXPECT_EQ(nodes.n_nodes(), body.mesh.n_nodes() + 8);
  EXPECT_EQ(nodes.block[0], body.mesh.block[0].node);
  for (std::size_t n = 0; n < 20; ++n)
    EXPECT_EQ(nodes.origin[static_cast<std::size_t>(nodes.block[1][n])], body.mesh.block[1].node[n]);
  EXPECT_THAT(region_numbers(body.mesh), testing::ElementsAre(0, 1));
  EXPECT_EQ(shared_nodes(body.mesh).n_nodes(), body.mesh.n_nodes());
}

TEST(TissueFields, JumpWhereRegionsMeet) {
  const TwoRegions body;
  const TissueFields fields(body.mesh, body.properties, {TissueField::cauchy_stress});
  const TissueState state = fields.at(moved(body.mesh, Matrix{{1.2, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  const auto& stress = values(state.at_nodes, "cauchy_stress");
  for (const Index soft : fields.nodes().block[0])
    for (const Index stiff : fields.nodes().block[1]) EXPECT_NEAR(stress(stiff, 0), 3 * stress(soft, 0), 1e-8);
}

TEST(TissueFields, AreNotANumberOrZeroWithoutFibres) {
  TwoRegions body;
  body.properties[1].material = example<MayNewman>();
  body.mesh.block[1].axes = {{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}};
  const TissueFields fields(body.mesh, body.properties, {TissueField::fibre_stretch, TissueField::fibre_direction});
  const TissueState state = fields.at(moved(body.mesh, Matrix{{1.2, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  const auto& stretch = values(state.at_nodes, "fibre_stretch");
  for (const Index node : fields.nodes().block[0]) EXPECT_TRUE(std::isnan(stretch(node, 0)));
  for (const Index node : fields.nodes().block[1]) EXPECT_NEAR(stretch(node, 0), 1.2, 1e-14);
  EXPECT_EQ(values(state.of_elements, "fibre_direction").row(0).norm(), 0);
  EXPECT_NEAR(values(state.of_elements, "fibre_direction")(1, 0), 1, 1e-14);
}

TEST(TissueFields, OfFibresNeedALawThatHasSome) {
  const TwoRegions body;
  EXPECT_THROW(TissueFields(body.mesh, body.properties, {TissueField::fibre_stretch}), report::SceneError);
}

}  // namespace
}  // namespace couplet::solid
