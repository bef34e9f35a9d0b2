#include "proto/surface/surface_mesh.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "proto/report/failure.hpp"

namespace couplet::surface {
namespace {

/// A triangle and a quadrilateral.
SurfaceMesh two_faces() {
  SurfaceMesh mesh;
  mesh.node_position = NodeArray::Random(5, 3);
  mesh.face_offset = (IndexArray(3) << 0, 3, 7).finished();
  mesh.face_node = (IndexArray(7) << 0, 1, 2, 1, 3, 4, 2).finished();
  mesh.face_region = (IndexArray(2) << 0, 1).finished();
  mesh.region = {"inferior", "medial"};
  mesh.marker = {{"B1", 4}};
  return mesh;
}

std::string complaint_about(const std::function<void(SurfaceMesh&)>& spoil) {
  SurfaceMesh mesh = two_faces();
  spoil(mesh);
  try {
    check_surface(mesh, "solid");
  } catch (const report::PeerError& error) {
    EXPECT_EQ(error.where(), "solid");
    EXPECT_EQ(error.advice(), "mend the program that offers it");
    return error.sentence();
  }
  return "";
}

TEST(SurfaceMesh, IsAcceptedWhenWhole) {
  EXPECT_NO_THROW(check_surface(two_faces(), "solid"));
  EXPECT_EQ(two_faces().n_faces(), 2);
}

TEST(SurfaceMesh, MayHaveNodesOnly) {
  SurfaceMesh mesh;
  mesh.node_position = NodeArray::Zero(4, 3);
  EXPECT_NO_THROW(check_surface(mesh, "flow"));
  EXPECT_EQ(mesh.n_faces(), 0);
}

TEST(SurfaceMesh, EachFaultIsNamed) {
  const auto fault = [](const std::string& sentence) { return "bad interface surface: " + sentence; };
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.node_position = NodeArray::Zero(5, 2); }),
            fault("node positions do not have 3 components"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.node_position(2, 1) = std::numeric_limits<double>::quiet_NaN(); }),
            fault("a node position is not finite"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_region = IndexArray::Zero(3); }),
            fault("face_region has 3 entries for 2 faces"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_offset(2) = 6; }),
            fault("face_offset does not span face_node"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_offset(1) = 2; }),
            fault("face 0 has 2 nodes, not 3, 4, 6 or 8"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_region(1) = 2; }), fault("face 1 has no region"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_region(0) = -1; }), fault("face 0 has no region"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_node(6) = 5; }), fault("a face names node 5 of 5"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.face_node(0) = -1; }), fault("a face names node -1 of 5"));
  EXPECT_EQ(complaint_about([](SurfaceMesh& m) { m.marker["B2"] = 5; }), fault("marker 'B2' names node 5"));
}

TEST(SurfaceMesh, CountsThatWouldReachOutOfTheArraysAreNotFollowed) {
  // Offsets that fall and rise again, and faces without offsets, as a broken peer may send them.
  EXPECT_NE(complaint_about([](SurfaceMesh& m) { m.face_offset(1) = 40; }), "");
  EXPECT_NE(complaint_about([](SurfaceMesh& m) { m.face_offset.resize(0); }), "");
}

}  // namespace
}  // namespace couplet::surface
