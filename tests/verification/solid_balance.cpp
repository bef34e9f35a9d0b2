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

/// Kinetic, strain and contact energy, less what came in, plus what damping took [J].
double imbalance(const SolidEnergy& energy) {
  return energy.kinetic + energy.strain + energy.contact - energy.flow->external_work + energy.flow->damping_work;
}

struct Balance {
  double worst = 0, largest_energy = 0;  // imbalance and energy over the run [J]
  SolidEnergy last;
};

/// `load`: on every wetted node at a time [N].
Balance balance_of(SolidSetup setup, double end, double step, double substep,
                   const std::function<Eigen::RowVector3d(double)>& load = {}) {
  setup.keeps_energy_balance = true;
  setup.step.largest_substep = substep;
  SolidModel model(setup);
  Balance balance;
  const auto n_wetted = static_cast<Eigen::Index>(model.wetted().solid_node.size());
  while (model.accepted().motion.time < end - step / 2) {
    surface::NodeArray force = surface::NodeArray::Zero(n_wetted, 3);
    if (load) force.rowwise() = load(model.accepted().motion.time + step);
    model.solve_step(step, force);
    model.accept_step();
    balance.last = model.energy();
    balance.worst = std::max(balance.worst, std::abs(imbalance(balance.last)));
    balance.largest_energy =
        std::max(balance.largest_energy, balance.last.kinetic + balance.last.strain + balance.last.contact);
  }
  return balance;
}

/// Every kind of load and support that does work: pressure, traction, gravity, interface load, kick, prescribed motion.
SolidSetup busy_block() {
  SolidSetup setup = tissue_block();
  setup.supports.prescribed = {
      {"z_min", 0, [](const Eigen::Vector3d&, double time) { return 5e-4 * (1 - std::cos(200 * time)); }},
      {"z_min", 1, [](const Eigen::Vector3d&, double) { return 0.0; }},
      {"z_min", 2, [](const Eigen::Vector3d&, double) { return 0.0; }}};
  setup.gravity = [](double) { return Eigen::Vector3d(0, 0, -9.81); };
  setup.pressures = {{"z_max", [](double time) { return 400 * std::sin(150 * time); }}};
  setup.tractions = {{"y_max", [](double time) { return Eigen::Vector3d(0, 0, 1e4 * time); }}};
  setup.wetted = {"x_min"};
  setup.kicks = {{7e-3, [](const Eigen::Vector3d& X) { return Eigen::Vector3d(0, 5 * X.z(), 0); }}};
  return setup;
}

const auto swinging = [](double time) { return Eigen::RowVector3d(2e-4 * std::sin(300 * time), 0, 1e-4); };

/// Worst imbalance over the largest energy, and its order in the substep.
void expect_order(double expected, const SolidSetup& setup, const std::function<Eigen::RowVector3d(double)>& load,
                  double substep) {
  const double end = 0.04, step = 1e-3;
  const Balance coarse = balance_of(setup, end, step, substep, load);
  const Balance fine = balance_of(setup, end, step, substep / 2, load);
  const double order = std::log2(coarse.worst / fine.worst);
  std::printf("substep %.3g s: imbalance %.2e of the largest energy, order %.2f; work %.3g J, damping %.3g J\n",
              substep, coarse.worst / coarse.largest_energy, order, coarse.last.flow->external_work,
              coarse.last.flow->damping_work);
  EXPECT_LE(coarse.worst, 1e-4 * coarse.largest_energy);  // (omega h)^2/8 of the modes that move, omega some 1000 rad/s
  EXPECT_NEAR(order, expected, 0.3);
}

TEST(EnergyBalance, ClosesWithTheSquareOfTheSubstepUnderEveryLoad) {
  expect_order(2, busy_block(), swinging, 2e-5);
}

TEST(EnergyBalance, CountsDampingByMass) {
  SolidSetup setup = busy_block();
  setup.damping = {40, 0.01, 100};
  expect_order(2, setup, swinging, 2e-5);
}

TEST(EnergyBalance, CountsDampingByStiffness) {
  SolidSetup setup = busy_block();
  setup.kicks.clear();  // at a jump of the velocity the strain energy at u + beta v jumps too, by terms of beta^2
  setup.damping.stiffness_factor = 2e-5;
  expect_order(1, setup, swinging, 1e-5);  // the damping force belongs to the velocity half a substep before
}

TEST(EnergyBalance, KnowsTheWorkOfAWeight) {
  // A block let go under gravity and damped until it stands: the weight does m g times the way of the centre of mass.
  SolidSetup setup = tissue_block();
  setup.supports.fixed = {"z_min"};
  setup.gravity = [](double) { return Eigen::Vector3d(0, 0, -9.81); };
  setup.damping.of_body = 500;
  setup.keeps_energy_balance = true;
  SolidModel model(setup);
  march(model, 0.1, 5e-3);
  double way = 0;  // sum of m u_z [kg m]
  const SolidEnergy energy = model.energy();
  const Eigen::VectorXd mass = lumped_mass(setup.mesh, {density});
  for (Index n = 0; n < setup.mesh.n_nodes(); ++n) way += mass[n] * model.accepted().motion.displacement(n, 2);
  // Constant forces: their sum over substeps is exact; a thousand substeps of round-off.
  EXPECT_NEAR(energy.flow->external_work / (-9.81 * way), 1, 1e-12);
  EXPECT_NEAR(energy.flow->damping_work, energy.flow->external_work - energy.strain, 1e-2 * energy.strain);
}

TEST(EnergyBalance, HoldsInAnImpactOnAPlane) {
  SolidSetup setup = tissue_block();
  setup.planes = {{{0, 0, -1e-3}, {0, 0, 1}, 0, {"z_min"}}};
  setup.planes[0].stiffness = 5e7;
  setup.kicks = {{0, [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, -0.5); }}};
  const Balance balance = balance_of(setup, 0.02, 1e-4, 5e-6);
  EXPECT_EQ(balance.last.flow->damping_work, 0);
  // The kick, m v^2/2, is all that comes in.
  EXPECT_NEAR(balance.last.flow->external_work / (density * volume * 0.125), 1, 1e-12);
  EXPECT_LE(balance.worst, 0.01 * balance.largest_energy);
}

TEST(EnergyBalance, HasTheSameBitsOnAnyTeamAndAfterAResume) {
  const auto run = [](int n_threads, bool with_resume) {
    SolidSetup setup = busy_block();
    setup.damping = {40, 0.01, 100};
    setup.damping.stiffness_factor = 1e-5;
    setup.keeps_energy_balance = true;
    setup.n_threads = n_threads;
    auto model = std::make_unique<SolidModel>(setup);
    march(*model, 0.01, 1e-3);
    if (with_resume) {
      const SolidState state = model->accepted();
      model = std::make_unique<SolidModel>(setup);
      model->resume(state);
    }
    model->solve_step(3e-3, surface::NodeArray::Ones(model->accepted().motion.interface_force.rows(), 3) * 1e-3);
    march(*model, 0.02, 1e-3);  // what was thrown away leaves no trace
    return model->energy();
  };
  const SolidEnergy one = run(1, false);
  for (const SolidEnergy& other : {run(2, false), run(3, true)}) {
    EXPECT_EQ(one.flow->external_work, other.flow->external_work);
    EXPECT_EQ(one.flow->damping_work, other.flow->damping_work);
    EXPECT_EQ(one.kinetic, other.kinetic);
  }
}

TEST(EnergyBalance, ChangesNothingInTheMotion) {
  SolidSetup setup = busy_block();
  setup.damping = {40, 0.01, 100};
  SolidModel without(setup);
  setup.keeps_energy_balance = true;
  SolidModel with(setup);
  march(without, 0.01, 1e-3);
  march(with, 0.01, 1e-3);
  EXPECT_EQ(without.accepted().motion.displacement, with.accepted().motion.displacement);
  EXPECT_FALSE(without.energy().flow.has_value());
}

}  // namespace
}  // namespace couplet::solid
