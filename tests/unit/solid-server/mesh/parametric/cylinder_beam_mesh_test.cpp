#include "solid-server/mesh/parametric/cylinder_beam_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "tests/unit/solid-server/mesh/mesh_measures.hpp"

namespace couplet::solid {
namespace {

TEST(CylinderBeamMesh, HasTheBenchmarksCornersAndRoot) {
  for (const std::array<int, 3> n : {std::array{10, 1, 1}, std::array{40, 4, 1}, std::array{9, 3, 2}}) {
    CylinderBeamShape shape;
    shape.n_elements = n;
    const SolidMesh mesh = make_cylinder_beam_mesh(shape);
    EXPECT_LE((mesh.node_position.row(mesh.marker.at("A")) - Eigen::RowVector3d(0.6, 0.2, 0)).norm(), 1e-15);
    for (const Index node : mesh.find_nodes("root", ""))
      EXPECT_NEAR((mesh.node_position.row(node).head<2>() - Eigen::RowVector2d(0.2, 0.2)).norm(), 0.05, 1e-15);
    for (const Index node : mesh.find_nodes("tip", "")) EXPECT_NEAR(mesh.node_position(node, 0), 0.6, 1e-15);
    for (const Index node : mesh.find_nodes("top", "")) EXPECT_NEAR(mesh.node_position(node, 1), 0.21, 1e-15);
    for (const Index node : mesh.find_nodes("bottom", "")) EXPECT_NEAR(mesh.node_position(node, 1), 0.19, 1e-15);
    for (const Index node : mesh.find_nodes("front", "")) EXPECT_NEAR(mesh.node_position(node, 2), 0.01, 1e-15);
    for (const Index node : mesh.find_nodes("back", "")) EXPECT_EQ(mesh.node_position(node, 2), 0);
    std::size_t n_faces = 0;
    for (const auto& surface : mesh.surface) n_faces += surface.second.size();
    EXPECT_EQ(n_faces, n_boundary_faces(mesh));
    EXPECT_NO_THROW(check_mesh(mesh, "beam"));
  }
}

TEST(CylinderBeamMesh, HasTheAreaOfTheSectionToFourthOrder) {
  // Area = (0.05 + 0.35) h - integral of sqrt(r^2 - y^2) over the root.
  const double r = 0.05, c = 0.01;
  const double exact = 0.4 * 0.02 - (c * std::sqrt(r * r - c * c) + r * r * std::asin(c / r));
  double last = 0;
  for (const int n_y : {1, 2, 4}) {
    CylinderBeamShape shape;
    shape.n_elements = {4, n_y, 1};
    const double error = std::abs(volume_of(make_cylinder_beam_mesh(shape)) / shape.depth - exact);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 4, 0.2);  // parabolas through three points of an arc
    }
    last = error;
  }
}

TEST(CylinderBeamMesh, RefusesABeamHigherThanTheCylinder) {
  CylinderBeamShape shape;
  shape.height = 0.1;
  try {
    make_cylinder_beam_mesh(shape);
    FAIL();
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(), "cylinder_beam: height of 0.1 m is not between 0 and the cylinder's diameter");
  }
}

}  // namespace
}  // namespace couplet::solid
