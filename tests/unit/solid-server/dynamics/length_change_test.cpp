#include "solid-server/dynamics/length_change.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"

namespace couplet::solid {
namespace {

constexpr double round_off = 1e-14;

/// Three cubes a side of a cube, or tetrahedra in them.
SolidMesh cubes(ElementShape shape) {
  return in_shape(make_box_mesh({Eigen::Vector3d::Ones(), {3, 3, 3}}), shape);
}

/// Of x = F X.
NodeVectors homogeneous(const SolidMesh& mesh, const Eigen::Matrix3d& F) {
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  u.leftCols<3>() = mesh.node_position * (F - Eigen::Matrix3d::Identity()).transpose();
  return u;
}

double change(const SolidMesh& mesh, const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  return LengthChange(mesh).largest(homogeneous(mesh, from), homogeneous(mesh, to), 0, 1);
}

const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();

TEST(LengthChange, IsNoneInARotation) {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const ElementShape shape : {ElementShape::hexahedron20, ElementShape::hexahedron8, ElementShape::tetrahedron10})
    EXPECT_NEAR(change(cubes(shape), rest, turned), 0, round_off);
}

TEST(LengthChange, IsThatOfTheEdgesInStretchAndCompression) {
  const Eigen::Matrix3d longer = Eigen::Vector3d(1.1, 1, 1).asDiagonal(),
                        shorter = Eigen::Vector3d(1, 0.8, 1).asDiagonal();
  for (const ElementShape shape :
       {ElementShape::hexahedron20, ElementShape::hexahedron8, ElementShape::tetrahedron10}) {
    EXPECT_NEAR(change(cubes(shape), rest, longer), 0.1, round_off);
    EXPECT_NEAR(change(cubes(shape), rest, shorter), 0.25, round_off);
    EXPECT_NEAR(change(cubes(shape), longer, rest), 0.1, round_off);
  }
}

TEST(LengthChange, SeesShearInTheDiagonals) {
  Eigen::Matrix3d sheared = rest;
  sheared(0, 1) = 0.2;
  // A diagonal (1, 1, 1) becomes (1.2, 1, 1); the longest edge grows by 2 % only.
  EXPECT_NEAR(change(cubes(ElementShape::hexahedron20), rest, sheared), std::sqrt(3.44 / 3) - 1, round_off);
}

TEST(LengthChange, IsTheSameForAnyNumberOfMembers) {
  const SolidMesh mesh = cubes(ElementShape::hexahedron20);
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) u.row(n) << 0.05 * std::sin(5 * n), 0.04 * std::cos(7 * n), 0, 0;
  const LengthChange lengths(mesh);
  const NodeVectors none = NodeVectors::Zero(mesh.n_nodes(), 4);
  double of_three = 0;
  for (int member = 0; member < 3; ++member) of_three = std::max(of_three, lengths.largest(none, u, member, 3));
  EXPECT_GT(of_three, 0.05);
  EXPECT_EQ(lengths.largest(none, u, 0, 1), of_three);
}

}  // namespace
}  // namespace couplet::solid
