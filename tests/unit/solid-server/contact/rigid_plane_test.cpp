#include "solid-server/contact/rigid_plane.hpp"

#include <gtest/gtest.h>

#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

/// The top faces of a box with nodes as `shape` has them: the eight of the mesh, their corners, or half of each face as
/// a triangle.
std::vector<FaceNodes> top_faces(const SolidMesh& mesh, FaceShape shape) {
  constexpr std::array<std::array<std::size_t, 8>, 3> kept = {
      {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3}, {3, 0, 1, 7, 4, 0}}};
  std::vector<FaceNodes> faces;
  for (const ElementFace& side : mesh.surface.at("y_max")) {
    const FaceNodes all = mesh.nodes_of(side);
    FaceNodes face(shape);
    for (std::size_t a = 0; a < face.size(); ++a) face[a] = all[kept[static_cast<std::size_t>(shape)][a]];
    faces.push_back(face);
  }
  return faces;
}

struct Contact {
  SolidMesh mesh = make_box_mesh({{1, 1, 1}, {3, 1, 3}});
  std::vector<FaceNodes> faces;
  PlaneContact contact;
  std::vector<StoredPack> buffer;
  std::vector<char> was_touching;

  explicit Contact(const RigidPlane& plane, FaceShape shape = FaceShape::quadrilateral8)
      : faces(top_faces(mesh, shape)), contact(mesh, faces, plane) {
    buffer.resize(static_cast<std::size_t>(contact.n_packs() * contact.faces().packs_of_force()));
    was_touching.resize(static_cast<std::size_t>(contact.n_packs()));
  }

  NodePositions force(const NodeVectors& displacement) {
    contact.force(0, contact.n_packs(), displacement.data(), buffer.data(), was_touching.data());
    NodePositions at_node = NodePositions::Zero(mesh.n_nodes(), 3);
    const double* values = &buffer.data()->lane[0];
    for (Index f = 0; f < static_cast<Index>(faces.size()); ++f)
      for (int a = 0; a < contact.faces().n_nodes; ++a)
        for (int i = 0; i < 3; ++i)
          at_node(faces[static_cast<std::size_t>(f)][static_cast<std::size_t>(a)], i) +=
              values[face_force_start(contact.faces(), f, a) + i];
    return at_node;
  }
};

const RigidPlane above_y{{0, 1, 0}, {0, -1, 0}, 1e4, {}};
const RigidPlane tilted{{0.5, 1, 0.5}, {0.3, -2, 0.5}, 1e4, {}};  // cuts through the top

NodeVectors lifted(const SolidMesh& mesh, double height) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    displacement(n, 1) = height + 0.05 * std::sin(4 * mesh.node_position(n, 0)) * mesh.node_position(n, 2);
  return displacement;
}

TEST(PlaneContact, PushesBackWithStiffnessTimesDepthTimesArea) {
  Contact c(above_y);
  NodeVectors displacement = NodeVectors::Zero(c.mesh.n_nodes(), 4);
  displacement.col(1).setConstant(0.02);
  const Eigen::RowVector3d total = c.force(displacement).colwise().sum();
  EXPECT_NEAR(total.y(), -1e4 * 0.02, 1e-10);
  EXPECT_EQ(total.x(), 0);
  EXPECT_NEAR(c.contact.total(displacement.data()).force, 1e4 * 0.02, 1e-10);
  EXPECT_NEAR(c.contact.total(displacement.data()).energy, 0.5 * 1e4 * 0.02 * 0.02, 1e-12);
}

TEST(PlaneContact, IsMinusTheDerivativeOfItsEnergyForAnyPlaneAndFace) {
  for (const FaceShape shape : {FaceShape::quadrilateral8, FaceShape::quadrilateral4, FaceShape::triangle6})
    for (const RigidPlane& plane : {above_y, tilted}) {
      Contact c(plane, shape);
      const NodeVectors at = lifted(c.mesh, 0.01);  // parts of the faces touch the plane, parts do not
      const NodePositions force = c.force(at);
      EXPECT_GT(force.cwiseAbs().maxCoeff(), 1);
      const double h = 1e-7;
      for (Index n = 0; n < c.mesh.n_nodes(); ++n)
        for (int i = 0; i < 3; ++i) {
          NodeVectors up = at, down = at;
          up(n, i) += h;
          down(n, i) -= h;
          const double slope = (c.contact.total(up.data()).energy - c.contact.total(down.data()).energy) / (2 * h);
          EXPECT_NEAR(force(n, i), -slope, 1e-5);  // round-off 1e-16 J / h, and points that begin to touch within h
        }
    }
}

TEST(PlaneContact, StiffnessIsMinusTheDerivativeOfTheForce) {
  for (const FaceShape shape : {FaceShape::quadrilateral8, FaceShape::quadrilateral4, FaceShape::triangle6}) {
    Contact c(tilted, shape);
    const NodeVectors at = lifted(c.mesh, 0.01);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(c.mesh.n_nodes(), c.mesh.n_nodes());
    c.contact.stiffness(at.data(), [&](Index a, Index b, double s) { K(a, b) += s; });
    const NodePositions before = c.force(at);
    const double h = 1e-7;
    for (Index b = 0; b < c.mesh.n_nodes(); ++b) {
      NodeVectors moved = at;
      moved.row(b).head<3>() += h * c.contact.normal().transpose();
      const NodePositions change = (c.force(moved) - before) / h;
      // The law is linear while no point begins or ends to touch; round-off 1e-14 N / h.
      for (Index a = 0; a < c.mesh.n_nodes(); ++a)
        EXPECT_LT((change.row(a) + K(a, b) * c.contact.normal().transpose()).norm(), 1e-6 * K.maxCoeff());
    }
  }
}

TEST(PlaneContact, LeavesNothingBehindWhenTheBodyLetsGo) {
  Contact c(above_y);
  EXPECT_GT(c.force(lifted(c.mesh, 0.05)).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(c.force(lifted(c.mesh, -0.2)).cwiseAbs().maxCoeff(), 0);
}

TEST(PlaneContact, StiffnessBoundIsNotBelowTheTrueStiffness) {
  Contact c(above_y);
  const Eigen::VectorXd bound = c.contact.stiffness_bound(c.mesh.n_nodes());
  NodeVectors deep = NodeVectors::Zero(c.mesh.n_nodes(), 4);
  deep.col(1).setConstant(0.1);
  const NodePositions before = c.force(deep);
  for (Index n = 0; n < c.mesh.n_nodes(); ++n) {
    NodeVectors moved = deep;
    moved(n, 1) += 0.01;
    const double row_sum = (c.force(moved) - before).col(1).cwiseAbs().sum() / 0.01;
    EXPECT_LE(row_sum, bound[n] * (1 + 1e-9) + 1e-9);
  }
}

}  // namespace
}  // namespace couplet::solid
