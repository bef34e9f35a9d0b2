// Claims about implicit steps: order in time, conservation, steps far above the explicit limit, repetition to the bit.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {
namespace {

void advance(SolidModel& model, double duration) {
  model.solve_step(duration, surface::NodeArray::Zero(model.accepted().motion.interface_force.rows(), 3));
  model.accept_step();
}

double total_energy(const SolidModel& model) {
  return model.energy().kinetic + model.energy().strain + model.energy().contact;
}

BlockProperties block_of(const Material& material, double density) {
  BlockProperties properties;
  properties.material = material;
  properties.density = density;
  return properties;
}

/// A clamped block of soft tissue under a pressure and an interface load that set in smoothly, with both dampings.
SolidSetup swaying_block(double spectral_radius) {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{0.01, 0.01, 0.02}, {1, 2, 2}});
  setup.properties = {block_of(MooneyRivlin{2290, 250, 100e3}, 1040)};
  setup.supports.fixed = {"z_min"};
  setup.wetted = {"x_min"};
  setup.damping = {20, 0, 0, 1e-4};
  setup.pressures = {{"z_max", [](double t) { return 300 * std::pow(std::sin(150 * t), 2); }}};
  setup.method = TimeMethod::generalized_alpha;
  setup.implicit.spectral_radius = spectral_radius;
  setup.implicit.newton.tolerance = 1e-9;
  return setup;
}

void sway(SolidModel& model, int n_steps, double end) {
  for (int n = 0; n < n_steps; ++n) {
    surface::NodeArray force = surface::NodeArray::Zero(model.accepted().motion.interface_force.rows(), 3);
    force.col(0).setConstant(4e-5 * std::pow(std::sin(100 * end * (n + 1) / n_steps), 2));
    model.solve_step(end / n_steps, force);
    model.accept_step();
  }
}

class SpectralRadius : public testing::TestWithParam<double> {};

TEST_P(SpectralRadius, LeavesStepsOfSecondOrder) {
  const auto state_after = [](int n_steps) {
    SolidModel model(swaying_block(GetParam()));
    sway(model, n_steps, 0.02);
    const Motion& motion = model.accepted().motion;
    return std::array<double, 2>{motion.displacement.col(0).mean(), motion.velocity.col(0).mean()};
  };
  const auto reference = state_after(1280), coarse = state_after(80), fine = state_after(160);
  for (const std::size_t n : {0u, 1u}) {
    const double order = std::log2(std::abs(coarse[n] - reference[n]) / std::abs(fine[n] - reference[n]));
    std::printf("rho = %.1f, %s: order %.2f\n", GetParam(), n == 0 ? "displacement" : "velocity", order);
    // The reference has an error of its own of (160/1280)^2 of the fine one; the rest is the next order.
    EXPECT_NEAR(order, 2, 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SpectralRadius, testing::Values(0.0, 0.5, 1.0));

/// A free cube of 1 m, 2 x 2 x 2 elements, E = 17 MPa, nu = 0.3, that turns at 20 rad/s.
SolidSetup spinning_cube() {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  setup.properties = {block_of(SaintVenantKirchhoff::from_young(17e6, 0.3), 1100)};
  setup.kicks = {
      {0, [](const Eigen::Vector3d& x) { return Eigen::Vector3d(-20 * (x.y() - 0.5), 20 * (x.x() - 0.5), 0); }}};
  setup.method = TimeMethod::generalized_alpha;
  return setup;
}

TEST(FreeSpinImplicit, KeepsEnergyBoundedAndAngularMomentum) {
  SolidSetup setup = spinning_cube();
  setup.implicit.spectral_radius = 1;
  setup.implicit.newton.tolerance = 1e-10;
  SolidModel model(setup);
  const double step = 2e-3;  // three times the stable step of the central difference method
  double energy = 0, momentum = 0, worst = 0, worst_momentum = 0;
  for (int n = 0; n < 500; ++n) {  // 1 s: three revolutions
    advance(model, step);
    if (n == 0) energy = total_energy(model), momentum = model.angular_momentum().z();
    worst = std::max(worst, std::abs(total_energy(model) / energy - 1));
    worst_momentum = std::max(worst_momentum, std::abs(model.angular_momentum().z() / momentum - 1));
  }
  std::printf("free spin: energy within %.1e, angular momentum within %.1e, %ld iterations, %ld factorisations\n",
              worst, worst_momentum, model.total_work().n_iterations, model.total_work().n_factorisations);
  EXPECT_LE(worst, 2e-3);           // (omega h)^2 = 1.6e-3
  EXPECT_LE(worst_momentum, 1e-9);  // the midpoint rule keeps it; what is left is the tolerance of 500 steps
}

/// A soft cantilever, 0.1 m long, that is plucked: half a period of its first mode is 0.3 s.
SolidSetup plucked_beam() {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{0.1, 0.01, 0.01}, {5, 1, 2}});
  setup.properties = {block_of(SaintVenantKirchhoff::from_young(15e3, 0.3), 1040)};
  setup.supports.fixed = {"x_min"};
  setup.tractions = {{"x_max", [](double t) { return Eigen::Vector3d(0, 0, 20 * std::pow(std::sin(4 * t), 2)); }}};
  return setup;
}

TEST(LongImplicitSteps, AreStableAndAccurateAtAHundredTimesTheExplicitLimit) {
  SolidSetup setup = plucked_beam();
  SolidModel by_substeps(setup);
  const double limit = by_substeps.accepted().motion.estimate.stable_step, step = 100 * limit;
  const int n_steps = static_cast<int>(std::ceil(0.4 / step));
  setup.method = TimeMethod::generalized_alpha;
  SolidModel model(setup);
  double largest_error = 0, largest = 0;
  for (int n = 0; n < n_steps; ++n) {
    advance(by_substeps, step);
    advance(model, step);
    const auto tip = [](const SolidModel& m) { return m.accepted().motion.displacement.col(2).maxCoeff(); };
    largest = std::max(largest, tip(by_substeps));
    largest_error = std::max(largest_error, std::abs(tip(model) - tip(by_substeps)));
  }
  std::printf("steps of %.2e s, 100 times the limit: tip to %.4f m, error %.1e m, %ld iterations in %d steps\n", step,
              largest, largest_error, model.total_work().n_iterations, n_steps);
  EXPECT_GT(largest, 0.01);                  // a tenth of the length: large rotations
  EXPECT_LE(largest_error, 0.03 * largest);  // a quarter of it is the difference of lumped and consistent mass
  EXPECT_LE(model.total_work().n_iterations, 6L * n_steps);
}

void expect_equal(const Motion& a, const Motion& b) {
  EXPECT_TRUE(a.displacement == b.displacement);
  EXPECT_TRUE(a.velocity == b.velocity);
  EXPECT_TRUE(a.acceleration == b.acceleration);
  EXPECT_TRUE(a.force == b.force);
}

TEST(ImplicitSteps, AreEqualBitsWhateverWasAskedBeforeAndByAnyNumberOfThreads) {
  SolidModel plain(swaying_block(0.8)), asked(swaying_block(0.8));
  SolidSetup setup = swaying_block(0.8);
  setup.n_threads = 2;
  SolidModel threaded(setup);
  const surface::NodeArray force =
      surface::NodeArray::Constant(plain.accepted().motion.interface_force.rows(), 3, 1e-5);
  for (int n = 0; n < 12; ++n) {
    plain.solve_step(1e-3, force);
    asked.solve_step(1e-3, 3 * force);  // another iteration of the coupling
    asked.solve_step(4e-4, force);      // a shorter step
    asked.solve_step(1e-3, force);
    threaded.solve_step(1e-3, force);
    plain.accept_step(), asked.accept_step(), threaded.accept_step();
    expect_equal(plain.accepted().motion, asked.accepted().motion);
    expect_equal(plain.accepted().motion, threaded.accepted().motion);
  }
}

TEST(ImplicitSteps, GoOnFromASavedStateWithEqualBits) {
  SolidModel through(swaying_block(0.8));
  sway(through, 7, 0.007);
  const SolidState saved = through.accepted();
  ASSERT_TRUE(saved.motion.factors.origin);
  SolidState copy = saved;  // as from a file: another object with the same numbers
  copy.motion.factors.origin = std::make_shared<const FactorOrigin>(*saved.motion.factors.origin);
  SolidModel resumed(swaying_block(0.8));
  resumed.resume(copy);
  for (int n = 0; n < 8; ++n) {
    advance(through, 1e-3);
    advance(resumed, 1e-3);
    expect_equal(through.accepted().motion, resumed.accepted().motion);
  }
}

TEST(PrescribedMotion, IsFollowedExactlyAndItsReactionIsTheInertia) {
  // A block between two plates that move together: it follows, and each moment its supports exert m a.
  for (const TimeMethod method : {TimeMethod::central_difference, TimeMethod::generalized_alpha}) {
    SolidSetup setup;
    setup.mesh = make_box_mesh({{0.01, 0.01, 0.01}, {2, 2, 2}});
    setup.properties = {block_of(SaintVenantKirchhoff::from_young(1e7, 0.3), 1000)};
    const auto place = [](double t) { return 1e-3 * (1 - std::cos(50 * t)); };
    for (const char* side : {"x_min", "x_max"})
      for (int axis = 0; axis < 3; ++axis)
        setup.supports.prescribed.push_back(
            {side, axis, [=](const Eigen::Vector3d&, double t) { return axis == 2 ? place(t) : 0; }});
    setup.damping.stiffness_factor = 1e-5;
    setup.method = method;
    SolidModel model(setup);
    for (int n = 0; n < 100; ++n) advance(model, 5e-4);
    const Motion& motion = model.accepted().motion;
    const double t = motion.time, acceleration = 2500 * 1e-3 * std::cos(50 * t);
    for (const Index node : model.mesh().find_nodes("x_max", "test")) {
      EXPECT_NEAR(motion.displacement(node, 2), place(t), 1e-15);
      EXPECT_EQ(motion.displacement(node, 0), 0);
      EXPECT_NEAR(motion.velocity(node, 2), 50e-3 * std::sin(50 * t), 1e-5 * 50e-3 + 2e-4 * 50e-3);
    }
    double reaction = 0;
    for (const Reaction& part : model.reactions()) reaction += part.force.z();
    // 1 g of mass; the block is stiff, and its own vibrations, begun by the sudden acceleration, are damped by now.
    EXPECT_NEAR(reaction, 1e-3 * acceleration, 0.02 * 1e-3 * 2.5);
  }
}

}  // namespace
}  // namespace couplet::solid
