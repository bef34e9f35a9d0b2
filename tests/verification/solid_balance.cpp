// Claims about what explicit runs report beside the motion: forces of supports, and where energy comes from and goes
// to.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "solid-server/element/mass.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {
namespace {

constexpr double density = 1100, volume = 1e-2 * 1e-2 * 2e-2;  // [kg/m^3] [m^3]

/// A block of soft tissue of 1 x 1 x 2 cm.
SolidSetup tissue_block() {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{0.01, 0.01, 0.02}, {2, 2, 4}});
  setup.properties = {{NeoHookean::from_young(5e4, 0.4), density}};
  return setup;
}

void march(SolidModel& model, double end, double step) {
  const surface::NodeArray load =
      surface::NodeArray::Zero(static_cast<Eigen::Index>(model.wetted().solid_node.size()), 3);
  while (model.accepted().motion.time < end - step / 2) {
    model.solve_step(step, load);
    model.accept_step();
  }
}

TEST(Reactions, OfABodyAtRestAreItsWeightAndItsLoads) {
  SolidSetup setup = tissue_block();
  setup.supports.fixed = {"z_min"};
  setup.supports.symmetry = {{"x_min", 0}};
  setup.gravity = [](double) { return Eigen::Vector3d(0, 0, -9.81); };
  setup.tractions = {{"z_max", [](double) { return Eigen::Vector3d(40, 25, 60); }}};
  setup.damping.of_body = 250;  // below the critical one of the slowest mode, which moves at some 155 rad/s
  SolidModel model(setup);
  march(model, 0.25, 5e-3);
  const auto reactions = model.reactions();
  ASSERT_EQ(reactions.size(), 2U);
  const Eigen::Vector3d total = reactions[0].force + reactions[1].force;
  const Eigen::Vector3d load = 1e-4 * Eigen::Vector3d(40, 25, 60) - volume * density * 9.81 * Eigen::Vector3d::UnitZ();
  // What is left of the motion after 0.25 s: exp(-125 / s * 0.25 s) = 3e-14 of the start, and round-off.
  EXPECT_LE((total + load).norm(), 1e-9 * load.norm()) << total.transpose();
  EXPECT_EQ(reactions[1].force.y(), 0);  // a symmetry plane holds one axis
  EXPECT_EQ(reactions[1].force.z(), 0);
}

TEST(Reactions, OfAPrescribedMotionAccelerateTheWholeBody) {
  constexpr double acceleration = 20;  // [m/s^2]
  SolidSetup setup = tissue_block();
  setup.supports.prescribed = {
      {"z_min", 2, [](const Eigen::Vector3d&, double time) { return acceleration * time * time / 2; }}};
  setup.damping.stiffness_factor = 2e-3;  // takes the vibration of the start, but nothing of the rigid motion
  SolidModel model(setup);
  march(model, 0.15, 5e-3);
  const auto reactions = model.reactions();
  ASSERT_EQ(reactions.size(), 1U);
  // Second differences of a parabola of 0.2 m over substeps of some 20 us: round-off 1e-17/4e-10, against 20.
  EXPECT_NEAR(reactions[0].force.z() / (density * volume * acceleration), 1, 1e-6);
}

}  // namespace
}  // namespace couplet::solid
