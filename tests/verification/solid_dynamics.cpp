// Claims about the motion of a body: conservation, order in time, stability limit, static limits.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/modal/modal_analysis.hpp"
#include "solid-server/solid_model.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"

namespace couplet::solid {
namespace {

const surface::NodeArray no_load = surface::NodeArray::Zero(0, 3);

void advance(SolidModel& model, double duration) {
  model.solve_step(duration, surface::NodeArray::Zero(model.accepted().motion.interface_force.rows(), 3));
  model.accept_step();
}

double total_energy(const SolidModel& model) {
  const SolidEnergy energy = model.energy();
  return energy.kinetic + energy.strain + energy.contact;
}

/// A free cube of 1 m, 4 x 4 x 4 elements, E = 17 MPa, nu = 0.3, 1100 kg/m^3.
SolidSetup rubber_cube() {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 1, 1}, {4, 4, 4}});
  setup.properties = {{SaintVenantKirchhoff::from_young(17e6, 0.3), 1100}};
  return setup;
}

Eigen::Vector3d angular_momentum(const SolidModel& model, const Eigen::VectorXd& mass) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Motion& motion = model.accepted().motion;
  for (Index n = 0; n < model.mesh().n_nodes(); ++n) {
    const Eigen::Vector3d x = model.mesh().node_position.row(n) + motion.displacement.row(n).head<3>();
    sum += mass[n] * x.cross(Eigen::Vector3d(motion.velocity.row(n).head<3>()));
  }
  return sum;
}

TEST(FreeSpin, KeepsAngularMomentumToRoundOffAndEnergyWithinAFewParts) {
  SolidSetup setup = rubber_cube();
  const Eigen::Vector3d omega(0, 0, 20);
  setup.kicks = {{0, [&](const Eigen::Vector3d& x) { return omega.cross(x - Eigen::Vector3d(0.5, 0.5, 0.5)); }}};
  SolidModel model(setup);
  const Eigen::VectorXd mass = lumped_mass(model.mesh(), {setup.properties[0].density});
  double energy = 0, worst = 0;
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (int n = 0; n < 400; ++n) {  // 2 s: six revolutions
    advance(model, 5e-3);
    if (n == 0) momentum = angular_momentum(model, mass), energy = total_energy(model);
    worst = std::max(worst, std::abs(total_energy(model) / energy - 1));
  }
  EXPECT_LE((angular_momentum(model, mass) - momentum).norm(),
            1e-12 * momentum.norm());  // some 4000 substeps of round-off
  EXPECT_LE(worst, 2e-4);              // substeps at 0.9 of the stability limit
}

TEST(FreeSpin, EnergyErrorIsBoundedAndFallsWithTheSquareOfTheSubstep) {
  const auto energy_error = [](double largest_substep) {
    SolidSetup setup = rubber_cube();
    setup.kicks = {
        {0, [](const Eigen::Vector3d& x) { return Eigen::Vector3d(-20 * (x.y() - 0.5), 20 * (x.x() - 0.5), 0); }}};
    setup.step.largest_substep = largest_substep;
    SolidModel model(setup);
    double first = 0, worst = 0;
    for (int n = 0; n < 200; ++n) {
      advance(model, 5e-3);
      if (n == 0) first = total_energy(model);
      worst = std::max(worst, std::abs(total_energy(model) / first - 1));
    }
    return worst;
  };
  const double coarse = energy_error(4e-4), fine = energy_error(2e-4);
  EXPECT_LE(coarse, 7e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

/// Mean x displacement of a clamped block of soft tissue after 4 ms under a pressure, damping and an interface load
/// that change in time.
double sway(int n_steps, double substep) {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{0.01, 0.01, 0.02}, {2, 2, 4}});
  setup.properties = {{MooneyRivlin{2290, 250, 100e3}, 1040}};
  setup.supports.fixed = {"z_min"};
  setup.wetted = {"x_min"};
  setup.damping = {20, 0, 0};
  setup.pressures = {{"z_max", [](double t) { return 300 * std::sin(300 * t); }}};
  setup.step.largest_substep = substep;
  SolidModel model(setup);
  const double end = 4e-3;
  const auto n_wetted = static_cast<Eigen::Index>(model.wetted().solid_node.size());
  for (int n = 0; n < n_steps; ++n) {
    surface::NodeArray force = surface::NodeArray::Zero(n_wetted, 3);
    force.col(0).setConstant(4e-5 * std::sin(1500 * end * (n + 1) / n_steps));
    model.solve_step(end / n_steps, force);
    model.accept_step();
  }
  return model.accepted().motion.displacement.col(0).mean();
}

TEST(CouplingStep, IsSecondOrderInTime) {
  // The same substeps throughout; what changes is how often the load is given. It is linear in between.
  const double reference = sway(320, 1.25e-5);
  const double coarse = std::abs(sway(10, 1.25e-5) - reference), fine = std::abs(sway(20, 1.25e-5) - reference);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

TEST(Substep, IsSecondOrderInTime) {
  // The same coupling steps throughout.
  const double reference = sway(20, 3.125e-6);
  const double coarse = std::abs(sway(20, 5e-5) - reference), fine = std::abs(sway(20, 2.5e-5) - reference);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

TEST(Damping, TakesWhatTheEnergyLoses) {
  // dE/dt = -2 c E_kin, summed by the trapezoidal rule over single substeps; the kick brings all the energy.
  SolidSetup setup = rubber_cube();
  const double c = 30;
  setup.damping = {10, 0.01, c - 10};
  setup.supports.fixed = {"x_min"};
  setup.kicks = {
      {0, [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.x(), 2 * x.x() * x.y(), -x.z() * x.x()); }}};
  setup.step.largest_substep = 1e-4;
  SolidModel model(setup);
  advance(model, 1e-4);
  const double first = total_energy(model);
  double lost = 0;
  for (int n = 1; n < 200; ++n) {
    const double damping = n < 100 ? c : 10;
    const double before = model.energy().kinetic;
    advance(model, 1e-4);
    lost += 1e-4 * damping * (before + model.energy().kinetic);
  }
  EXPECT_GT(lost, 0.15 * first);
  EXPECT_NEAR(total_energy(model) + lost, first, 1e-3 * first);  // second order: 0.2 of the stable step
}

TEST(Damping, OfAnySizeIsStable) {
  SolidSetup setup = rubber_cube();
  setup.damping.of_body = 1e6;  // a thousand times what one substep can take explicitly
  setup.kicks = {{0, [](const Eigen::Vector3d& x) { return x; }}};
  SolidModel model(setup);
  for (int n = 0; n < 50; ++n) advance(model, 1e-3);
  EXPECT_LE(model.accepted().motion.velocity.cwiseAbs().maxCoeff(), 1);
  EXPECT_TRUE(model.accepted().motion.displacement.allFinite());
}

FreeComponents free_of(const SolidSetup& setup) {
  const Eigen::VectorXd mass = lumped_mass(setup.mesh, {setup.properties[0].density});
  return free_components(inverse_mass(setup.mesh, mass, setup.supports));
}

/// The body moves in one mode from rest, so that its energy falls as exp(-beta omega^2 t).
TEST(Damping, ByStiffnessTakesFromEachModeByTheSquareOfItsFrequency) {
  SolidSetup setup = rubber_cube();
  setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  setup.supports.fixed = {"x_min"};
  WorkTeam team(1);
  TangentSolver body(setup.mesh, setup.properties, free_of(setup), team, MassForm::lumped);
  const auto modes = modal_analysis(body, NodeVectors::Zero(setup.mesh.n_nodes(), 4), 21);
  for (const std::size_t k : {std::size_t{0}, std::size_t{20}}) {
    const double omega = std::sqrt(modes[k].eigenvalue), period = 2 * M_PI / omega;
    const NodeVectors& shape = modes[k].shape;
    setup.kicks = {{0, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
                      Index nearest = 0;
                      (setup.mesh.node_position.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
                      return 1e-3 * shape.row(nearest).head<3>().transpose();  // small: the mode stays linear
                    }}};
    setup.damping.stiffness_factor = 0.1 / (period * omega * omega);  // a tenth of the energy in a period
    setup.step.largest_substep = period / 200;
    SolidModel model(setup);
    advance(model, period);
    const double first = total_energy(model);
    advance(model, 4 * period);
    // Lag of half a substep and energy at u + beta v: (omega h)^2 and beta omega, of one per cent together.
    EXPECT_NEAR(std::log(total_energy(model) / first), -0.4, 0.004) << "mode " << k;
  }
}

/// After 5000 substeps of a share of the stable step, from a kick that holds every frequency.
double largest_motion(SolidSetup setup, double safety) {
  setup.step.safety = safety;
  setup.kicks = {{0, [](const Eigen::Vector3d& x) {
                    return Eigen::Vector3d(1e-3 * std::sin(40 * x.y()), 1e-3 * std::cos(50 * x.z()), 0);
                  }}};
  SolidModel model(setup);
  for (int n = 0; n < 100; ++n) advance(model, 50 * safety * model.accepted().motion.estimate.stable_step);
  return model.accepted().motion.displacement.cwiseAbs().maxCoeff();
}

TEST(Damping, ByStiffnessShortensTheStableStepAsItIsSaidTo) {
  SolidSetup setup = rubber_cube();
  setup.supports.fixed = {"x_min"};
  const double undamped = SolidModel(setup).accepted().motion.estimate.stable_step;
  setup.damping.stiffness_factor = undamped;  // zeta = 1 at the highest frequency
  EXPECT_NEAR(SolidModel(setup).accepted().motion.estimate.stable_step, (std::sqrt(2.0) - 1) * undamped,
              1e-9 * undamped);
  EXPECT_LE(largest_motion(setup, 0.99), 1e-4);
  EXPECT_THROW(largest_motion(setup, 1.05), report::NumericsError);
}

TEST(BouncingCube, KeepsItsEnergyThroughContact) {
  SolidSetup setup = rubber_cube();
  setup.wetted = {"y_max"};
  setup.planes = {{{0, 1.05, 0}, {0, -1, 0}, 1e9, {}}};
  setup.step.safety = 0.5;
  setup.kicks = {{0, [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 5, 0); }}};
  SolidModel model(setup);
  const double energy = 0.5 * 25 * 1100;
  double deepest = 0, worst = 0;
  for (int n = 0; n < 300; ++n) {  // 60 ms: there, through the contact, and back
    advance(model, 2e-4);
    deepest = std::max(deepest, model.energy().contact);
    worst = std::max(worst, std::abs(total_energy(model) / energy - 1));
  }
  EXPECT_GT(deepest, 1e-4 * energy);
  EXPECT_EQ(model.energy().contact, 0);
  const Eigen::VectorXd mass = lumped_mass(model.mesh(), {setup.properties[0].density});
  EXPECT_LT(mass.dot(model.accepted().motion.velocity.col(1)) / mass.sum(), -3);  // it has bounced
  EXPECT_LE(worst, 5e-3);  // half the stable substep, and a penalty that switches on and off
}

TEST(UniaxialPressure, ReachesTheHomogeneousSolution) {
  // Symmetry planes on three sides, pressure on one. Mooney-Rivlin at axial stretch 0.8: nominal stress -3908.9929 Pa,
  // lateral stretch 1.1121292 (computed independently by root finding); the pressure acts on the deformed area.
  SolidSetup setup;
  setup.mesh = make_box_mesh({{0.01, 0.01, 0.01}, {2, 2, 2}});
  setup.properties = {{MooneyRivlin{2290, 250, 100e3}, 1040}};
  setup.supports.symmetry = {{"x_min", 0}, {"y_min", 1}, {"z_min", 2}};
  const double pressure = 3908.9929 / (1.1121292 * 1.1121292);
  setup.pressures = {{"x_max", [=](double t) { return pressure * std::min(1.0, t / 0.02); }}};
  setup.damping = {0, 1, 600};
  SolidModel model(setup);
  for (int n = 0; n < 150; ++n) advance(model, 1e-3);
  const auto& u = model.accepted().motion.displacement;
  EXPECT_NEAR(u.col(0).minCoeff() / 0.01, -0.2, 1e-6);
  EXPECT_NEAR(u.col(1).maxCoeff() / 0.01, 0.1121292, 1e-6);
  EXPECT_NEAR(u.col(2).maxCoeff() / 0.01, 0.1121292, 1e-6);
}

/// Of M^-1/2 K M^-1/2 with lumped mass, all of its columns written out [1/s^2].
double largest_eigenvalue(const SolidSetup& setup) {
  const Index n_nodes = setup.mesh.n_nodes();
  WorkTeam team(1);
  TangentSolver body(setup.mesh, setup.properties, free_of(setup), team, MassForm::lumped);
  body.assemble(NodeVectors::Zero(n_nodes, 4), {1, 0});
  const NodeVectors scale =
      inverse_mass(setup.mesh, lumped_mass(setup.mesh, {setup.properties[0].density}), setup.supports).cwiseSqrt();
  Eigen::MatrixXd matrix(4 * n_nodes, 4 * n_nodes);
  for (Index column = 0; column < 4 * n_nodes; ++column) {
    NodeVectors unit = NodeVectors::Zero(n_nodes, 4);
    unit.data()[column] = scale.data()[column];
    const NodeVectors product = body.multiply(unit).cwiseProduct(scale);
    matrix.col(column) = Eigen::Map<const Eigen::VectorXd>(product.data(), product.size());
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

TEST(StableStep, IsJustBelowTheExactOne) {
  for (const Material& material :
       {Material(SaintVenantKirchhoff::from_young(17e6, 0.3)), Material(MooneyRivlin{2290, 250, 1e5})})
    for (const int n_points : {8, 27}) {
      SolidSetup setup = rubber_cube();
      setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
      setup.properties = {{material, 1100, n_points}};
      setup.supports.fixed = {"x_min"};
      const double found = SolidModel(setup).accepted().motion.estimate.stable_step;
      const double exact = 2 / std::sqrt(largest_eigenvalue(setup));
      EXPECT_LE(found, exact * (1 + 1e-6));  // the stiffness is applied as a difference of forces
      EXPECT_GE(found, 0.99 * exact);
      const double wave_time =
          0.5 / std::sqrt(std::visit([](const auto& law) { return law.pressure_wave_modulus(); }, material) /
                          setup.properties[0].density);
      EXPECT_NEAR(found / wave_time, 0.28, 0.025);  // the rule of thumb for cubes
    }
}

TEST(StableStep, IsWhereTheMotionBeginsToDiverge) {
  SolidSetup setup = rubber_cube();
  setup.supports.fixed = {"x_min"};
  EXPECT_LE(largest_motion(setup, 0.99), 1e-4);
  EXPECT_THROW(largest_motion(setup, 1.05), report::NumericsError);
}

}  // namespace
}  // namespace couplet::solid
