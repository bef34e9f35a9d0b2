#include "solid-server/support/rigid_motion.hpp"

#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/support/supports.hpp"

namespace couplet::solid {
namespace {

std::string refusal(const Supports& supports) {
  const SolidMesh mesh = make_box_mesh({{3, 2, 1}, {3, 2, 1}});
  const Eigen::VectorXd mass = Eigen::VectorXd::Ones(mesh.n_nodes());
  try {
    check_rigid_motion(mesh, free_components(inverse_mass(mesh, mass, supports)), "here");
  } catch (const report::SceneError& error) {
    EXPECT_EQ(error.where(), "here");
    return error.sentence();
  }
  return "";
}

TEST(RigidMotion, IsRefusedWithTheNamesOfWhatIsFree) {
  const std::string after = " as a whole: statics cannot say where it stands";
  EXPECT_EQ(refusal({{}, {}}), "the body can shift along x, y and z and turn about every axis" + after);
  EXPECT_EQ(refusal({{}, {{"x_min", 0}}}), "the body can shift along y and z and turn about x" + after);
  EXPECT_EQ(refusal({{}, {{"x_min", 0}, {"y_min", 1}}}), "the body can shift along z" + after);
}

TEST(RigidMotion, IsAllowedWhereNothingIsFree) {
  EXPECT_EQ(refusal({{"z_min"}, {}}), "");
  EXPECT_EQ(refusal({{}, {{"x_min", 0}, {"y_min", 1}, {"z_min", 2}}}), "");
  // A surface that is moved along one axis and held along another.
  const PrescribedMotion pull{"x_max", 0, [](const Eigen::Vector3d&, double t) { return t; }};
  EXPECT_EQ(refusal({{}, {{"y_min", 1}, {"z_min", 2}}, {pull}}), "");
}

TEST(RigidMotion, AboutAHingeIsNamedByItsAxis) {
  SolidMesh mesh = make_box_mesh({{3, 2, 1}, {3, 2, 1}});
  FreeComponents free = FreeComponents::Constant(mesh.n_nodes(), 3, true);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (mesh.node_position(n, 0) < 1e-9 && mesh.node_position(n, 2) < 1e-9) free.row(n).setConstant(false);
  try {
    check_rigid_motion(mesh, free, "here");
    ADD_FAILURE();
  } catch (const report::SceneError& error) {
    EXPECT_EQ(error.sentence(), "the body can turn about y as a whole: statics cannot say where it stands");
  }
}

}  // namespace
}  // namespace couplet::solid
