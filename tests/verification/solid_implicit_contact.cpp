// Claims about contact in static and implicit steps: exact stress under a plane and between blocks, impact without
// passing through, momentum and energy.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "solid-server/element/mass.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {
namespace {

constexpr double young_modulus = 15e3, density = 1040;

SolidSetup setup_of(SolidMesh mesh, double poisson_ratio) {
  SolidSetup setup;
  setup.mesh = std::move(mesh);
  setup.properties.assign(setup.mesh.block.size(),
                          {SaintVenantKirchhoff::from_young(young_modulus, poisson_ratio), density});
  return setup;
}

void advance(SolidModel& model, double duration) {
  model.solve_step(duration, surface::NodeArray::Zero(0, 3));
  model.accept_step();
}

/// The stretch at which a column of `length`, shortened by `way` less what its contact gives way by, stands in
/// equilibrium: P(lambda) + k gap = 0 with P = E/2 (lambda^3 - lambda), gap = lambda length - (length - way).
double stretch_in_equilibrium(double length, double way, double stiffness) {
  double low = 0.6, high = 1;  // P rises with lambda above 1/sqrt(3)
  for (int n = 0; n < 60; ++n) {
    const double lambda = (low + high) / 2, P = young_modulus / 2 * (std::pow(lambda, 3) - lambda),
                 gap = lambda * length - (length - way);
    (P + stiffness * gap > 0 ? high : low) = lambda;
  }
  return (low + high) / 2;
}

constexpr double side = 0.01, way = 0.002;

TEST(PressedBlock, HasTheExactUniaxialStateOnARigidPlane) {
  const double k = 1e7;
  SolidSetup setup = setup_of(make_box_mesh({{side, side, side}, {2, 2, 2}}), 0.3);
  setup.supports.symmetry = {{"x_min", 0}, {"y_min", 1}};
  setup.supports.prescribed = {{"z_max", 2, [](const Eigen::Vector3d&, double t) { return -way * t; }}};
  RigidPlane plane;
  plane.normal = Eigen::Vector3d::UnitZ();
  plane.stiffness = k;
  plane.surfaces = {"z_min"};
  setup.planes = {plane};
  setup.method = TimeMethod::static_equilibrium;
  SolidModel model(setup);
  for (int n = 0; n < 2; ++n) advance(model, 0.5);

  const double lambda = stretch_in_equilibrium(side, way, k);
  const double gap = lambda * side - (side - way);
  EXPECT_NEAR(model.energy().contact_force / (k * gap * side * side), 1, 1e-6);  // the tolerance of the iteration
  // One lateral stretch: E_22 = - nu E_11.
  const double lateral = std::sqrt(1 - 0.3 * (lambda * lambda - 1));
  const Motion& motion = model.accepted().motion;
  for (Index n = 0; n < model.mesh().n_nodes(); ++n) {
    const auto X = model.mesh().node_position.row(n);
    EXPECT_NEAR(motion.displacement(n, 0), (lateral - 1) * X[0], 1e-6 * way);
    EXPECT_NEAR(motion.displacement(n, 2), lambda * X[2] - gap - X[2], 1e-6 * way);
  }
}

TEST(PressedBlock, HasTheExactUniaxialStateOnAnotherBlock) {
  const double d0 = 5e-4, k = 5e6;
  SolidMesh below = make_box_mesh({{side, side, side}, {2, 2, 1}}), above = below;
  above.node_position.col(2).array() += side + d0;
  for (const TimeMethod method : {TimeMethod::static_equilibrium, TimeMethod::generalized_alpha}) {
    SolidSetup setup = setup_of(join_bodies({below, above}, {"below", "above"}), 0.3);
    setup.supports.symmetry = {
        {"below/x_min", 0}, {"above/x_min", 0}, {"below/y_min", 1}, {"above/y_min", 1}, {"below/z_min", 2}};
    setup.supports.prescribed = {
        {"above/z_max", 2, [](const Eigen::Vector3d&, double t) { return -2 * way * std::min(t, 1.0); }}};
    setup.contacts = {{"below/z_max", "above/z_min", k, d0}};
    setup.damping.of_body = 100;           // [1/s]: in half a second slow vibration decays by exp(-25),
    setup.implicit.spectral_radius = 0.2;  // what steps do not resolve by 0.2^25
    setup.method = method;
    SolidModel model(setup);
    for (int n = 0; n < 75; ++n) advance(model, 0.02);
    // Two columns share the way and the gap.
    const double lambda = stretch_in_equilibrium(2 * side, 2 * way, k), gap = 2 * (lambda * side - (side - way));
    EXPECT_NEAR(model.energy().contact_force / (k * gap * side * side), 1, 1e-6);  // the tolerance of the iteration
    EXPECT_NEAR(*model.energy().contact_distance, d0 - gap, 1e-6 * gap);
  }
}

/// Bars of a row of cubes, nu = 0, that fly towards each other at a relative velocity of 2 v.
struct Bars {
  double length = 0.01, velocity = 0.1, distance = 1e-4;
  int n_elements = 20;
};

SolidSetup bars_before_impact(const Bars& bars, double gap) {
  const double size = bars.length / bars.n_elements;
  SolidMesh left = make_box_mesh({{bars.length, size, size}, {bars.n_elements, 1, 1}}), right = left;
  right.node_position.col(0).array() += bars.length + bars.distance + gap;
  SolidSetup setup = setup_of(join_bodies({left, right}, {"left", "right"}), 0);
  setup.contacts = {{"left/x_max", "right/x_min", 0, bars.distance}};
  const double middle = bars.length + bars.distance / 2, v = bars.velocity;
  setup.kicks = {{0, [=](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.x() < middle ? v : -v, 0, 0); }}};
  setup.method = TimeMethod::generalized_alpha;
  return setup;
}

/// x of the momentum of all bodies [kg m/s].
double momentum(const SolidModel& model, const Eigen::VectorXd& mass) {
  return mass.dot(model.accepted().motion.velocity.col(0));
}

double total(const SolidEnergy& energy) {
  return energy.kinetic + energy.strain + energy.contact;
}

/// From first to last touch, of blocks that meet at v each: a shock there, at the speed of its secant, and the head of
/// the release back, at the speed of the tangent, of P = E/2 (lambda^3 - lambda); and what contact of stiffness k = E/h
/// adds by giving way, 0.84 h/c (solid_contact.cpp).
double expected_duration(const Bars& bars) {
  const double c = std::sqrt(young_modulus / density), lambda = 1 - bars.velocity / c;
  const double shock = c * std::sqrt(lambda * (lambda + 1) / 2), release = c * std::sqrt((3 * lambda * lambda - 1) / 2);
  return bars.length / shock + bars.length / release + 0.84 * bars.length / bars.n_elements / c;
}

TEST(ImplicitCollision, KeepsMomentumAndGetsNoEnergyFromContact) {
  const Bars bars;
  const double c = std::sqrt(young_modulus / density), impact = 2 * bars.length / c;
  for (const int n_steps_of_impact : {25, 50, 100, 200}) {
    SolidModel model(bars_before_impact(bars, 1e-4));
    const Eigen::VectorXd mass = row_sums_of_mass(model.mesh(), {density, density});
    const double step = impact / n_steps_of_impact, momentum_of_one = mass.sum() / 2 * bars.velocity;
    double start_energy = 0, largest_energy = 0, largest_momentum = 0, begin = 0, end = 0;
    int n_touches = 0;
    bool touched = false;
    for (int n = 0; n < 2 * n_steps_of_impact; ++n) {
      advance(model, step);
      const SolidEnergy energy = model.energy();
      if (n == 0) start_energy = total(energy);
      largest_energy = std::max(largest_energy, total(energy));
      largest_momentum = std::max(largest_momentum, std::abs(momentum(model, mass)));
      const bool touches = energy.contact_force > 0;
      n_touches += touches && !touched;
      touched = touches;
      if (touched) end = model.accepted().motion.time;
      if (begin == 0) begin = end;
    }
    const auto half = mass.size() / 2;
    const double speed =
        mass.tail(half).dot(model.accepted().motion.velocity.col(0).tail(half)) / mass.tail(half).sum();
    std::printf(
        "implicit collision, %d steps an impact: momentum %.1e, largest energy %.5f, last %.5f, duration %.4f "
        "of 2 L/c, speed after %.4f\n",
        n_steps_of_impact, largest_momentum / momentum_of_one, largest_energy / start_energy,
        total(model.energy()) / start_energy, (end - begin) / impact, speed / bars.velocity);
    EXPECT_LT(largest_momentum, 1e-12 * momentum_of_one);  // round-off: no iteration, finished or not, changes it
    // A step in which contact begins sees it at one moment only. What that can mistake is what contact stores in a
    // step at the speed of approach, k (2 v dt)^2 / 2, beside rho L v^2; it falls with the square of the step.
    const double stored = 2 * c * c * step * step / (bars.length * bars.length / bars.n_elements);
    EXPECT_LT(largest_energy / start_energy, 1 + stored);
    EXPECT_GT(total(model.energy()) / start_energy, 0.99);  // damped is only what steps do not resolve
    EXPECT_EQ(n_touches, 1);
    // The mesh carries the front of the wave over two elements or so; a step at the start and one at the end.
    EXPECT_NEAR(end - begin, expected_duration(bars), 2 * bars.length / bars.n_elements / c + 2 * step);
    EXPECT_GT(speed / bars.velocity, 1 - 1.0 / bars.n_elements);
  }
}

/// Two plates that would fly through each other in one step: 4 mm, where contact pushes over 0.25 mm.
TEST(ImplicitCollision, CutsStepsThatWouldPassThroughASheet) {
  const double h = 3e-4, v = 2, d0 = 1e-4;
  SolidMesh below = make_box_mesh({{3e-3, 3e-3, h}, {2, 2, 1}}), above = below;
  above.node_position.col(2).array() += h + 1.5e-3;
  SolidSetup setup = setup_of(join_bodies({below, above}, {"below", "above"}), 0.4);
  for (BlockProperties& block : setup.properties) block = {SaintVenantKirchhoff::from_young(1.5e6, 0.4), 1000};
  setup.contacts = {{"below/z_max", "above/z_min", 0, d0}};
  setup.kicks = {{0, [=](const Eigen::Vector3d& x) { return Eigen::Vector3d(0, 0, x.z() < 1e-3 ? v : -v); }}};
  setup.method = TimeMethod::generalized_alpha;
  SolidModel model(setup);
  double smallest = d0;
  bool is_cut = false;
  const double start_energy = 1000 * 9e-6 * h * v * v;
  for (int n = 0; n < 3; ++n) {
    advance(model, 1e-3);
    smallest = std::min(smallest, *model.energy().contact_distance);
    is_cut |= model.work_of_last_step().is_cut_for_contact;
  }
  EXPECT_TRUE(is_cut);
  EXPECT_GT(smallest, 0);
  const Motion& motion = model.accepted().motion;
  const auto half = motion.velocity.rows() / 2;
  EXPECT_LT(motion.velocity.col(2).head(half).mean(), -0.5 * v);  // back where they came from
  EXPECT_GT(motion.velocity.col(2).tail(half).mean(), 0.5 * v);
  EXPECT_LT(total(model.energy()), start_energy);
}

}  // namespace
}  // namespace couplet::solid
