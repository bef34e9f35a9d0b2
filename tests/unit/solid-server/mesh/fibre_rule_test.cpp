#include "solid-server/mesh/fibre_rule.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/annulus_mesh.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

std::string refusal(const FibreRule& rule, const SolidMesh& mesh) {
  try {
    axes_by_rule(rule, mesh, mesh.block.front(), "solid.fibres");
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FibreRule, GivesConstantDirections) {
  const SolidMesh mesh = make_box_mesh({{1, 1, 1}, {2, 1, 1}});
  const auto axes = axes_by_rule(ConstantFibres{{0, 2, 0}, {1, 1, 0}}, mesh, mesh.block.front(), "");
  ASSERT_EQ(axes.size(), 2u);
  EXPECT_EQ(axes[1][0], Eigen::Vector3d(0, 1, 0));
  EXPECT_LE((axes[1][1] - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(refusal(ConstantFibres{{1, 0, 0}, {2, 0, 0}}, mesh),
            "solid.fibres: the directions along and across the fibres are parallel or have no length; give two "
            "directions across "
            "each other");
}

TEST(FibreRule, GivesDirectionsAroundALine) {
  SolidMesh mesh = make_annulus_mesh({1, 2, 1, std::numbers::pi / 2, {1, 3, 1}});
  const auto around = axes_by_rule(CircumferentialFibres{{0, 0, 7}, {0, 0, 2}}, mesh, mesh.block.front(), "");
  for (std::size_t e = 0; e < 3; ++e) {
    const double theta = (static_cast<double>(e) + 0.5) * std::numbers::pi / 6;
    const Eigen::Vector3d tangential(-std::sin(theta), std::cos(theta), 0);
    EXPECT_LE((around[e][0] - tangential).norm(), 1e-14);
    EXPECT_LE((around[e][1] - Eigen::Vector3d::UnitZ()).norm(), 1e-14);
  }
  const SolidMesh box = make_box_mesh({});
  EXPECT_EQ(
      refusal(CircumferentialFibres{{0.5, 0.5, 0}, {0, 0, 1}}, box),
      "solid.fibres: element 0 at (0.5, 0.5, 0.5) m stands on the line that fibres run around, or the line has no "
      "direction; choose another line");
}

}  // namespace
}  // namespace couplet::solid
