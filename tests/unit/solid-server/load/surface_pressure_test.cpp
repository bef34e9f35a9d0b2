#include "solid-server/load/surface_pressure.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"

namespace couplet::solid {
namespace {

std::vector<FaceNodes> all_faces(const SolidMesh& mesh) {
  std::vector<FaceNodes> faces;
  for (const auto& [name, side] : mesh.surface)
    for (const ElementFace& face : side) faces.push_back(mesh.nodes_of(face));
  return faces;
}

/// Forces on the nodes of a mesh, (n_nodes, 3).
NodePositions nodal_forces(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, double pressure,
                           const NodeVectors& displacement) {
  const FacePacks packs = make_face_packs(mesh, faces);
  std::vector<StoredPack> buffer(static_cast<std::size_t>(packs.n_packs * packs.packs_of_force()));
  pressure_force(packs, 0, packs.n_packs, pressure, displacement.data(), buffer.data());
  NodePositions force = NodePositions::Zero(mesh.n_nodes(), 3);
  const double* values = &buffer.data()->lane[0];
  for (Index f = 0; f < packs.n_faces; ++f)
    for (int a = 0; a < packs.n_nodes; ++a)
      for (int i = 0; i < 3; ++i)
        force(faces[static_cast<std::size_t>(f)][static_cast<std::size_t>(a)], i) +=
            values[face_force_start(packs, f, a) + i];
  return force;
}

NodeVectors bulged(const SolidMesh& mesh) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d X = mesh.node_position.row(n);
    displacement.row(n) << 0.2 * std::sin(3 * X.y()), 0.3 * X.x() * X.z(), 0.2 * std::cos(4 * X.x() + X.y()), 0;
  }
  return displacement;
}

class PressureForceOn : public testing::TestWithParam<ElementShape> {};

TEST_P(PressureForceOn, AClosedSurfaceIsZeroInForceAndMoment) {
  const SolidMesh mesh = in_shape(make_box_mesh({{1, 1, 1}, {2, 3, 2}}), GetParam());
  const NodeVectors displacement = bulged(mesh);
  const NodePositions force = nodal_forces(mesh, all_faces(mesh), 1000, displacement);
  EXPECT_LE(force.colwise().sum().cwiseAbs().maxCoeff(), 1e-12 * 1000);  // round-off of p times an area of 1 m^2
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d x = mesh.node_position.row(n) + displacement.row(n).head<3>();
    moment += x.cross(Eigen::Vector3d(force.row(n)));
  }
  // The quadrature is exact to degree 5 a direction; x times the area vector has degree 5 along curved edges.
  EXPECT_LE(moment.cwiseAbs().maxCoeff(), 1e-12 * 1000);
}

INSTANTIATE_TEST_SUITE_P(Shapes, PressureForceOn,
                         testing::Values(ElementShape::hexahedron20, ElementShape::hexahedron8,
                                         ElementShape::tetrahedron10));

TEST(PressureForce, PushesOntoTheBodyWithPressureTimesArea) {
  const SolidMesh mesh = make_box_mesh({{2, 3, 1}, {3, 2, 1}});
  std::vector<FaceNodes> top;
  for (const ElementFace& face : mesh.surface.at("z_max")) top.push_back(mesh.nodes_of(face));
  NodeVectors stretched = NodeVectors::Zero(mesh.n_nodes(), 4);
  stretched.col(0) = 0.5 * mesh.node_position.col(0);  // the area follows the deformation: 3 x 3
  const Eigen::Vector3d total = nodal_forces(mesh, top, 7, stretched).colwise().sum();
  EXPECT_NEAR(total.x(), 0, 1e-12);
  EXPECT_NEAR(total.y(), 0, 1e-12);
  EXPECT_NEAR(total.z(), -7 * 9, 1e-11);
}

}  // namespace
}  // namespace couplet::solid
