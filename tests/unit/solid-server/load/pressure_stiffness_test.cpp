#include "solid-server/load/pressure_stiffness.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "solid-server/load/surface_pressure.hpp"
#include "solid-server/load/surface_rim.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

constexpr double pressure = 7;

struct PressedBox {
  SolidMesh mesh = make_box_mesh({{1, 0.8, 0.6}, {2, 2, 1}});
  std::vector<FaceNodes> face_nodes;
  FacePacks faces;
  NodeVectors displacement;

  explicit PressedBox(const std::vector<std::string>& surfaces) {
    for (const std::string& surface : surfaces)
      for (const ElementFace& face : mesh.find_surface(surface, "test")) face_nodes.push_back(mesh.nodes_of(face));
    faces = make_face_packs(mesh, face_nodes);
    displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      for (int i = 0; i < 3; ++i) displacement(n, i) = 0.1 * std::sin(3.0 * n + 5.0 * i);
  }

  Eigen::VectorXd force(const NodeVectors& u) const {
    std::vector<StoredPack> packs(static_cast<std::size_t>(faces.n_packs * faces.packs_of_force()));
    pressure_force(faces, 0, faces.n_packs, pressure, u.data(), packs.data());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * mesh.n_nodes());
    for (std::size_t f = 0; f < face_nodes.size(); ++f)
      for (int a = 0; a < faces.n_nodes; ++a)
        for (int i = 0; i < 3; ++i)
          sum[3 * face_nodes[f][static_cast<std::size_t>(a)] + i] +=
              (&packs.data()->lane[0])[face_force_start(faces, static_cast<Index>(f), a) + i];
    return sum;
  }

  Eigen::MatrixXd stiffness() const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * mesh.n_nodes(), 3 * mesh.n_nodes());
    pressure_stiffness(faces, pressure, displacement,
                       [&](Index a, Index b, const Eigen::Matrix3d& C) { K.block<3, 3>(3 * a, 3 * b) += C; });
    return K;
  }
};

TEST(PressureStiffness, IsMinusTheDerivativeOfTheForce) {
  const PressedBox box({"x_max", "z_max"});
  const Eigen::MatrixXd K = box.stiffness();
  constexpr double step = 1e-4;
  for (Index n = 0; n < box.mesh.n_nodes(); ++n)
    for (int i = 0; i < 3; ++i) {
      NodeVectors up = box.displacement, down = box.displacement;
      up(n, i) += step, down(n, i) -= step;
      const Eigen::VectorXd slope = (box.force(down) - box.force(up)) / (2 * step);
      // The force is of second order in one component: central differences leave round-off, 1e-16 over the step.
      EXPECT_LE((K.col(3 * n + i) - slope).norm(), 1e-10 * pressure);
    }
}

TEST(PressureStiffness, IsSymmetricOnAClosedSurface) {
  const PressedBox closed({"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}), open({"z_max"});
  const auto asymmetry = [](const Eigen::MatrixXd& K) { return (K - K.transpose()).norm() / K.norm(); };
  EXPECT_LE(asymmetry(closed.stiffness()), 1e-13);
  EXPECT_GT(asymmetry(open.stiffness()), 1e-3);
}

TEST(PressureStiffness, IsUnsymmetricOnTheRimOnly) {
  const PressedBox open({"x_max", "z_max"});
  const Eigen::MatrixXd K = open.stiffness(), skew = (K - K.transpose()) / 2;
  const std::vector<Index> rim = nodes_of_rim(open.face_nodes);
  const auto is_on_rim = [&](Index node) { return std::binary_search(rim.begin(), rim.end(), node); };
  double largest = 0;
  for (Index a = 0; a < open.mesh.n_nodes(); ++a)
    for (Index b = 0; b < open.mesh.n_nodes(); ++b) {
      const double size = skew.block<3, 3>(3 * a, 3 * b).norm();
      if (is_on_rim(a) && is_on_rim(b))
        largest = std::max(largest, size);
      else
        EXPECT_LE(size, 1e-14 * K.norm());  // round-off
    }
  EXPECT_GT(largest, 1e-3 * K.norm());
}

TEST(Rim, IsWhereOneFaceEnds) {
  const PressedBox closed({"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}), open({"z_max"});
  EXPECT_TRUE(nodes_of_rim(closed.face_nodes).empty());
  const std::vector<Index> rim = nodes_of_rim(open.face_nodes);
  EXPECT_EQ(rim.size(), 16u);  // eight edges of two nodes each
  for (const Index node : rim) {
    const Eigen::Vector3d X = open.mesh.node_position.row(node);
    const double from_edge = std::min({X.x(), 1 - X.x(), X.y(), 0.8 - X.y()});
    EXPECT_NEAR(from_edge, 0, 1e-12);
    EXPECT_NEAR(X.z(), 0.6, 1e-12);
  }
}

}  // namespace
}  // namespace couplet::solid
