#include "solid-server/contact/rigid_plane.hpp"

#include <gtest/gtest.h>

#include "solid-server/mesh/box_mesh.hpp"

namespace couplet::solid {
namespace {

struct Contact {
  SolidMesh mesh = make_box_mesh({{1, 1, 1}, {3, 1, 3}});
  std::vector<FaceNodes> faces;
  PlaneContact contact;
  std::vector<StoredPack> buffer;
  std::vector<char> was_touching;

  explicit Contact(std::vector<RigidPlane> planes) : faces(top()), contact(mesh, faces, std::move(planes)) {
    buffer.resize(static_cast<std::size_t>(contact.n_packs() * contact.faces().packs_of_force()));
    was_touching.resize(static_cast<std::size_t>(contact.n_packs()));
  }

  std::vector<FaceNodes> top() const {
    std::vector<FaceNodes> out;
    for (const ElementFace& face : mesh.surface.at("y_max")) out.push_back(mesh.nodes_of(face));
    return out;
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

NodeVectors lifted(const SolidMesh& mesh, double height) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    displacement(n, 1) = height + 0.05 * std::sin(4 * mesh.node_position(n, 0)) * mesh.node_position(n, 2);
  return displacement;
}

TEST(PlaneContact, PushesBackWithStiffnessTimesDepthTimesArea) {
  Contact c({{1.0, 1e4}});
  NodeVectors displacement = NodeVectors::Zero(c.mesh.n_nodes(), 4);
  displacement.col(1).setConstant(0.02);
  const Eigen::RowVector3d total = c.force(displacement).colwise().sum();
  EXPECT_NEAR(total.y(), -1e4 * 0.02, 1e-10);
  EXPECT_EQ(total.x(), 0);
  EXPECT_NEAR(c.contact.total(displacement.data()).force, 1e4 * 0.02, 1e-10);
  EXPECT_NEAR(c.contact.total(displacement.data()).energy, 0.5 * 1e4 * 0.02 * 0.02, 1e-12);
}

TEST(PlaneContact, IsMinusTheDerivativeOfItsEnergy) {
  Contact c({{1.0, 1e4}, {1.03, 2e4}});
  const NodeVectors at = lifted(c.mesh, 0.01);  // parts of the faces touch one plane, parts both, parts none
  const NodePositions force = c.force(at);
  const double h = 1e-7;
  for (Index n = 0; n < c.mesh.n_nodes(); ++n) {
    NodeVectors up = at, down = at;
    up(n, 1) += h;
    down(n, 1) -= h;
    const double slope = (c.contact.total(up.data()).energy - c.contact.total(down.data()).energy) / (2 * h);
    EXPECT_NEAR(force(n, 1), -slope, 1e-5);  // round-off 1e-16 J / h, and points that begin to touch within h
  }
}

TEST(PlaneContact, LeavesNothingBehindWhenTheBodyLetsGo) {
  Contact c({{1.0, 1e4}});
  EXPECT_GT(c.force(lifted(c.mesh, 0.05)).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(c.force(lifted(c.mesh, -0.2)).cwiseAbs().maxCoeff(), 0);
}

TEST(PlaneContact, StiffnessBoundIsNotBelowTheTrueStiffness) {
  Contact c({{1.0, 1e4}});
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
