#include "flow-server/one_dimensional/fold_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/extruded_fold.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;

surface::SurfaceMesh fold() {
  return make_surface({.outline = fold_outline, .n_across = 5, .n_rows = 3});
}

std::string refusal_of(const surface::SurfaceMesh& mesh) {
  try {
    FoldSurface surface(mesh);
  } catch (const report::PeerError& error) {
    return error.what();
  }
  return "accepted";
}

/// The same surface with every face numbered from its n-th corner.
surface::SurfaceMesh turned(surface::SurfaceMesh mesh, int n) {
  const surface::IndexArray old = mesh.face_node;
  for (std::int64_t face = 0; face < mesh.n_faces(); ++face) {
    for (int i = 0; i < 4; ++i) {
      mesh.face_node[8 * face + i] = old[8 * face + (i + n) % 4];
      mesh.face_node[8 * face + 4 + i] = old[8 * face + 4 + (i + n) % 4];
    }
  }
  return mesh;
}

TEST(FoldSurface, TurnsEveryFaceSoThatItsFirstParameterRunsAcrossTheFold) {
  for (int n = 0; n < 4; ++n) {
    const FoldSurface surface(turned(fold(), n));
    EXPECT_EQ(surface.n_faces(), 15);
    const auto& z = surface.reference().z;
    for (const FaceBatch& batch : surface.batches()) {
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        EXPECT_EQ(z[batch.node[0][lane]], z[batch.node[1][lane]]);
        EXPECT_EQ(z[batch.node[2][lane]], z[batch.node[3][lane]]);
        EXPECT_NE(z[batch.node[1][lane]], z[batch.node[2][lane]]);
      }
    }
  }
}

TEST(FoldSurface, SortsItsFacesIntoRowsThatRiseInZ) {
  const FoldSurface surface(fold());
  ASSERT_EQ(surface.rows().size(), 3U);
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(surface.rows()[row].z_low, 0.01 * static_cast<double>(row) / 3, 1e-15);
    EXPECT_NEAR(surface.rows()[row].z_high, 0.01 * static_cast<double>(row + 1) / 3, 1e-15);
  }
}

TEST(FoldSurface, RefusesFacesThatAreNotQuadratic) {
  surface::SurfaceMesh mesh;
  mesh.node_position.setZero(4, 3);
  mesh.node_position.col(0) << 0, 1, 1, 0;
  mesh.node_position.col(2) << 0, 0, 1, 1;
  mesh.face_offset.setZero(2);
  mesh.face_offset[1] = 4;
  mesh.face_node = surface::IndexArray::LinSpaced(4, 0, 3);
  mesh.face_region.setZero(1);
  mesh.region = {"wetted"};
  EXPECT_THAT(refusal_of(mesh), HasSubstr("face 0 has 4 nodes, not 8"));
}

TEST(FoldSurface, RefusesAFaceThatIsNotExtrudedAlongZ) {
  surface::SurfaceMesh mesh = fold();
  mesh.node_position(mesh.face_node[8 * 7 + 2], 0) += 1e-4;
  EXPECT_THAT(refusal_of(mesh), HasSubstr("does not have two straight edges along z"));
}

TEST(FoldSurface, RefusesRowsThatOverlap) {
  surface::SurfaceMesh mesh = fold();
  surface::SurfaceMesh other = make_surface({.outline = fold_outline, .n_across = 5, .n_rows = 2});
  const std::int64_t n_nodes = mesh.n_nodes(), n_faces = mesh.n_faces();
  mesh.node_position.conservativeResize(n_nodes + other.n_nodes(), 3);
  mesh.node_position.bottomRows(other.n_nodes()) = other.node_position;
  mesh.face_node.conservativeResize(8 * (n_faces + other.n_faces()));
  mesh.face_node.tail(8 * other.n_faces()) = (other.face_node.array() + n_nodes).matrix();
  mesh.face_offset = surface::IndexArray::LinSpaced(n_faces + other.n_faces() + 1, 0, 8 * (n_faces + other.n_faces()));
  mesh.face_region.setZero(n_faces + other.n_faces());
  EXPECT_THAT(refusal_of(mesh), HasSubstr("overlaps the row"));
}

TEST(FoldSurface, RefusesASurfaceWithoutFaces) {
  surface::SurfaceMesh mesh;
  mesh.node_position.setZero(3, 3);
  mesh.face_offset.setZero(1);
  EXPECT_THAT(refusal_of(mesh), HasSubstr("no faces"));
}

}  // namespace
}  // namespace couplet::flow
