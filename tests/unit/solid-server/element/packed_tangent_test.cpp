#include "solid-server/element/packed_tangent.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solid-server/element/tangent.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "tests/unit/solid-server/element/deformed_body.hpp"
#include "tests/unit/solid-server/material/material_examples.hpp"

namespace couplet::solid {
namespace {

/// Ten hexahedra (a pack and a part of one) with curved edges; each has its own axes.
SolidMesh hexahedra() {
  SolidMesh mesh = make_box_mesh({{5, 2, 1}, {5, 2, 1}});
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    mesh.node_position.row(n) += 0.04 * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
  for (Index e = 0; e < mesh.n_elements(); ++e)
    mesh.block[0].axes.push_back({Eigen::Vector3d(std::cos(e), std::sin(e), 0), Eigen::Vector3d(0, 0, 1)});
  return mesh;
}

/// Nine tetrahedra, each with nodes of its own.
SolidMesh tetrahedra() {
  const ElementTopology& shape = topology(ElementShape::tetrahedron10);
  SolidMesh mesh;
  mesh.block.emplace_back().shape = ElementShape::tetrahedron10;
  mesh.node_position.resize(9 * shape.n_nodes, 3);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const auto& at = shape.coordinate[static_cast<std::size_t>(n % shape.n_nodes)];
    mesh.node_position.row(n) << at[0] + 0.3 * at[1], 1.2 * at[1], 0.9 * at[2] - 0.2 * at[0];
    mesh.node_position.row(n) += 0.03 * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
    mesh.block[0].node.push_back(n);
  }
  for (Index e = 0; e < mesh.n_elements(); ++e)
    mesh.block[0].axes.push_back({Eigen::Vector3d(0, std::cos(e), std::sin(e)), Eigen::Vector3d(1, 0, 0)});
  return mesh;
}

struct MeshCase {
  const char* name;
  SolidMesh (*mesh)();
  int n_points;
};

class PackedTangentOf : public testing::TestWithParam<MeshCase> {};

TEST_P(PackedTangentOf, AgreesWithThePlainFormForEveryLaw) {
  const SolidMesh mesh = GetParam().mesh();
  const ElementBlock& block = mesh.block[0];
  const int n_points = GetParam().n_points, n_nodes = topology(block.shape).n_nodes;
  const ElementPacks packs = make_element_packs(mesh, block, n_points);
  const NodeVectors displacement = wavy(mesh);
  std::vector<StoredPack> blocks(static_cast<std::size_t>(9 * n_local_pairs(n_nodes) * packs.n_packs));
  for (const Material& material :
       {Material(example<SaintVenantKirchhoff>()), Material(example<NeoHookean>()), Material(example<MooneyRivlin>()),
        Material(example<HolzapfelGasserOgden>()), Material(example<MayNewman>())}) {
    // In two calls, as members of a team do.
    const std::size_t second = static_cast<std::size_t>(9 * n_local_pairs(n_nodes));
    EXPECT_EQ(packed_tangent(packs, material, 1, packs.n_packs, displacement.data(), &blocks[second]), -1);
    EXPECT_EQ(packed_tangent(packs, material, 0, 1, displacement.data(), blocks.data()), -1);
    for (Index e = 0; e < mesh.n_elements(); ++e) {
      const auto nodes = mesh.nodes_of(e);
      PlainElement element{material, block.shape, n_points, at_element(mesh.node_position, nodes)};
      for (std::size_t axis = 0; axis < 2; ++axis)
        for (int J = 0; J < 3; ++J) element.axes.at[axis][J] = block.axes[static_cast<std::size_t>(e)][axis][J];
      const ElementTangent K = element_tangent(element, at_element(displacement, nodes));
      const double round_off = 1e-13 * K.cwiseAbs().maxCoeff();
      for (int b = 0; b < n_nodes; ++b)
        for (int a = b; a < n_nodes; ++a)
          for (int c = 0; c < 9; ++c) {
            const Index place = (e / n_lanes * n_local_pairs(n_nodes) + local_pair(n_nodes, a, b)) * 9 + c;
            const double found = blocks[static_cast<std::size_t>(place)].lane[e % n_lanes];
            ASSERT_NEAR(found, K(3 * a + c / 3, 3 * b + c % 3), round_off)
                << "law " << material.index() << ", pair " << a << " " << b << ", entry " << c;
          }
    }
  }
}

TEST_P(PackedTangentOf, DiffersByTheSecondOrderOfTheStepThatLedToIt) {
  // Stress and pressure that are linear along a step differ from those at its end by the square of the step.
  const SolidMesh mesh = GetParam().mesh();
  const ElementPacks packs = make_element_packs(mesh, mesh.block[0], GetParam().n_points);
  const NodeVectors displacement = wavy(mesh);
  NodeVectors step = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    step.row(n) << 1e-2 * std::sin(2 * mesh.node_position(n, 1)), 1e-2 * mesh.node_position(n, 0), 0, 0;
  const auto blocks_after = [&](const Material& material, const NodeVectors* increment) {
    std::vector<StoredPack> blocks(static_cast<std::size_t>(9 * n_local_pairs(packs.n_nodes) * packs.n_packs));
    packed_tangent(packs, material, 0, packs.n_packs, displacement.data(), blocks.data(),
                   increment ? increment->data() : nullptr);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(&blocks[0].lane[0], 8 * static_cast<long>(blocks.size())));
  };
  const NodeVectors half = step / 2;
  for (const Material& material :
       {Material(example<SaintVenantKirchhoff>()), Material(example<NeoHookean>()), Material(example<MooneyRivlin>()),
        Material(example<HolzapfelGasserOgden>()), Material(example<MayNewman>())}) {
    const Eigen::VectorXd at_end = blocks_after(material, nullptr);
    const double whole_step = (blocks_after(material, &step) - at_end).norm();
    EXPECT_GT(whole_step, 1e-6 * at_end.norm());
    // 4 but for the third order, which is a hundredth here, more in stiff fibres.
    EXPECT_NEAR(whole_step / (blocks_after(material, &half) - at_end).norm(), 4, 0.3) << "law " << material.index();
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, PackedTangentOf,
                         testing::Values(MeshCase{"hexahedra8", hexahedra, 8}, MeshCase{"hexahedra14", hexahedra, 14},
                                         MeshCase{"hexahedra27", hexahedra, 27}, MeshCase{"tetrahedra4", tetrahedra, 4},
                                         MeshCase{"tetrahedra15", tetrahedra, 15}),
                         [](const auto& of) { return of.param.name; });

TEST(PackedTangent, NamesTheElementThatIsTurnedInsideOut) {
  const SolidMesh mesh = make_box_mesh({{20, 1, 1}, {20, 1, 1}});
  const ElementPacks packs = make_element_packs(mesh, mesh.block[0], 8);
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)  // the end of element 12 passes through it
    if (std::abs(mesh.node_position(n, 0) - 13) < 1e-9) displacement(n, 0) = -2.5;
  std::vector<StoredPack> blocks(static_cast<std::size_t>(9 * n_local_pairs(20) * packs.n_packs));
  EXPECT_EQ(
      packed_tangent(packs, example<SaintVenantKirchhoff>(), 0, packs.n_packs, displacement.data(), blocks.data()), 12);
}

}  // namespace
}  // namespace couplet::solid
