#include "solid-server/mesh/place_mesh.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "solid-server/mesh/parametric/valve_mesh.hpp"

namespace couplet::solid {
namespace {

TEST(PlaceMesh, TurnsThenMovesNodesAndTurnsAxes) {
  const SolidMesh made = make_valve_mesh({});
  SolidMesh placed = made;
  // A third of a turn about the diagonal: (x, y, z) -> (z, x, y).
  const Eigen::AngleAxisd turn(2 * std::numbers::pi / 3, Eigen::Vector3d(1, 1, 1).normalized());
  place_mesh(Eigen::Translation3d(1, 2, 3) * turn, placed);
  constexpr double round_off = 1e-14;  // of coordinates of 3 m and of unit vectors, some operations each
  for (Index node = 0; node < made.n_nodes(); ++node) {
    const Eigen::Vector3d x = made.node_position.row(node), y = placed.node_position.row(node);
    ASSERT_LE((y - Eigen::Vector3d(1 + x.z(), 2 + x.x(), 3 + x.y())).norm(), round_off);
  }
  for (std::size_t b = 0; b < made.block.size(); ++b)
    for (std::size_t e = 0; e < made.block[b].axes.size(); ++e)
      for (std::size_t k = 0; k < 2; ++k) {
        const Eigen::Vector3d &a = made.block[b].axes[e][k], &c = placed.block[b].axes[e][k];
        ASSERT_LE((c - Eigen::Vector3d(a.z(), a.x(), a.y())).norm(), round_off);
      }
  EXPECT_FALSE(made.block.front().axes.empty());
}

}  // namespace
}  // namespace couplet::solid
