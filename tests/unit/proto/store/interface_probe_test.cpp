#include "proto/store/interface_probe.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"

namespace couplet::store {
namespace {

surface::SurfaceMesh three_nodes() {
  surface::SurfaceMesh mesh;
  mesh.node_position = (surface::NodeArray(3, 3) << 0, 0, 0, 1, 0, 0, 2, 0, 0).finished();
  mesh.marker = {{"B1", 2}, {"B2", 0}};
  return mesh;
}

v1::Output output(const std::string& text) {
  v1::Output message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message));
  return message;
}

TEST(InterfaceProbe, FollowsAMarkerOrTheNearestNode) {
  const auto probes = make_probes(output("probe { name: 'a' at { marker: 'B1' } }"
                                         "probe { name: 'b' at { position { x: 1.2 y: 5 } } }"),
                                  three_nodes());
  ASSERT_EQ(probes.size(), 2U);
  EXPECT_EQ(probes[0].node, 2);
  EXPECT_EQ(probes[1].node, 1);
  const auto columns = probe_columns(probes);
  ASSERT_EQ(columns.size(), 6U);
  EXPECT_EQ(columns[4].name, "b.y");
  EXPECT_EQ(columns[4].unit, "m");
  std::vector<double> row{0.5};
  append_probe_values(probes, (surface::NodeArray(3, 3) << 1, 2, 3, 4, 5, 6, 7, 8, 9).finished(), row);
  EXPECT_THAT(row, testing::ElementsAre(0.5, 7, 8, 9, 4, 5, 6));
}

TEST(InterfaceProbe, ListsTheMarkersWhenOneIsMissing) {
  try {
    make_probes(output("probe { name: 'a' at { marker: 'C1' } }"), three_nodes());
    FAIL() << "was found";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(), "output.probe[0].at: the surface has no marker 'C1'; its markers are: B1, B2");
  }
}

}  // namespace
}  // namespace couplet::store
