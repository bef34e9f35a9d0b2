#include "solid-server/service/make_setup.hpp"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

TEST(Placement, TurnsAndMovesABody) {
  v1::Solid solid;
  const std::string text = R"(body {
      name: "block"
      box { length { x: 3 y: 2 z: 1 } }
      material { density: 1 neo_hookean { shear_modulus: 1 bulk_modulus: 1 } }
      fixed: "x_min"
      placement { rotation_axis { z: 2 } rotation_angle: 90 translation { x: 10 y: 20 z: 30 } }
    })";
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &solid));
  const SolidMesh mesh = make_setup(solid, ".").mesh;
  // (x, y, z) -> (10 - y, 20 + x, 30 + z), to the round-off of 30 m.
  EXPECT_TRUE(mesh.node_position.colwise().minCoeff().isApprox(Eigen::RowVector3d(8, 20, 30), 1e-15));
  EXPECT_TRUE(mesh.node_position.colwise().maxCoeff().isApprox(Eigen::RowVector3d(10, 23, 31), 1e-15));
  for (const Index node : mesh.find_nodes("x_min", "")) EXPECT_NEAR(mesh.node_position(node, 1), 20, 1e-14);

  solid.mutable_body(0)->mutable_placement()->mutable_rotation_axis()->set_z(0);
  try {
    make_setup(solid, ".");
    ADD_FAILURE() << "an axis without a direction is accepted";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "solid.body[0].placement.rotation_axis: the axis (0, 0, 0) has no direction; give it a length");
  }
}

TEST(WorthwhileThreads, AreNeverMoreThanOfferedAndOneForASmallBody) {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 1, 1}, {10, 10, 10}});
  setup.properties = {{MooneyRivlin{1, 1, 1}, 1, 8}};
  EXPECT_EQ(worthwhile_threads(4, setup), 2);  // 8000 points, at least 4000 for each
  setup.properties.front().n_points = 27;
  EXPECT_EQ(worthwhile_threads(4, setup), 4);
  EXPECT_GE(worthwhile_threads(0, setup), 1);
  setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  EXPECT_EQ(worthwhile_threads(4, setup), 1);
}

}  // namespace
}  // namespace couplet::solid
