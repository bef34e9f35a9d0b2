// Pistons that move a fluid column: implicit schemes against the closed form, explicit ones against their limit of
// stability.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "proto/report/failure.hpp"
#include "tests/oracle/coupled_march.hpp"
#include "tests/oracle/piston.hpp"

namespace couplet::oracle {
namespace {

v1::Coupling implicit(v1::Coupling::Scheme scheme) {
  v1::Coupling coupling;
  coupling.set_scheme(scheme);
  v1::Convergence* criterion = coupling.add_convergence();
  criterion->set_field("displacement");
  criterion->set_relative(1e-10);  // far below the errors in time that are measured
  return coupling;
}

CoupledMarch march_piston(double added_mass, TimeRule rule, const v1::Coupling& coupling, double end, double step) {
  const PistonRow row = one_piston(added_mass);
  PistonFlow flow(row, rule);
  PistonSolid solid(row, rule);
  return march(flow, solid, coupling, end, step);
}

double end_error(double added_mass, TimeRule rule, const v1::Coupling& coupling, double end, double step) {
  const CoupledMarch run = march_piston(added_mass, rule, coupling, end, step);
  const Eigen::VectorXd exact = one_piston(added_mass).exact_displacement(end);
  return std::abs(run.steps.back().state.motion(1) - exact(0));
}

class ImplicitPiston : public testing::TestWithParam<v1::Coupling::Scheme> {};
INSTANTIATE_TEST_SUITE_P(Both, ImplicitPiston,
                         testing::Values(v1::Coupling::SERIAL_IMPLICIT, v1::Coupling::PARALLEL_IMPLICIT),
                         [](const auto& scheme) { return v1::Coupling::Scheme_Name(scheme.param); });

TEST_P(ImplicitPiston, ConvergesToTheClosedFormWithTheOrderOfTheTimeRule) {
  for (const double added_mass : {0.01, 0.1, 1., 10., 100.}) {
    const double period = 2 * M_PI * std::sqrt(1 + added_mass);
    for (const auto& [rule, order] : {std::pair(TimeRule::backward, 1), std::pair(TimeRule::trapezoidal, 2)}) {
      const double end = period / 3;
      const double coarse = end_error(added_mass, rule, implicit(GetParam()), end, end / 100);
      const double fine = end_error(added_mass, rule, implicit(GetParam()), end, end / 200);
      // 5 % of the order: the next term of the expansion at 300 steps a period.
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.05 * order) << "added mass " << added_mass;
    }
  }
}

TEST_P(ImplicitPiston, NeedsFewIterationsForAnyAddedMass) {
  for (const double added_mass : {0.01, 0.1, 1., 10., 100.}) {
    const CoupledMarch run = march_piston(added_mass, TimeRule::trapezoidal, implicit(GetParam()), 10, 0.1);
    EXPECT_LE(run.iterations_max(), 8)
        << added_mass;  // one direction (two in parallel): a probe, its secant, round-off
    EXPECT_EQ(run.n_discarded, 0) << added_mass;
  }
}

TEST(ConstantRelaxationPiston, ConvergesOnlyBelowTwoOverOnePlusAddedMass) {
  v1::Coupling coupling = implicit(v1::Coupling::SERIAL_IMPLICIT);
  coupling.set_iterations_max(2000);
  coupling.set_halvings_max(0);
  v1::ConstantRelaxation* constant = coupling.mutable_constant();
  constant->set_force(1);
  const double added_mass = 9;  // |1 - omega (1 + 9)| < 1 means omega < 0.2
  constant->set_displacement(0.19), constant->set_velocity(0.19);
  EXPECT_NO_THROW(march_piston(added_mass, TimeRule::backward, coupling, 0.02, 0.01));
  constant->set_displacement(0.21), constant->set_velocity(0.21);
  EXPECT_THROW(march_piston(added_mass, TimeRule::backward, coupling, 0.02, 0.01), report::NumericsError);
}

/// Largest displacement over the whole run, or infinity when the run was given up.
double largest_explicit_displacement(double added_mass, double step) {
  v1::Coupling coupling;
  coupling.set_scheme(v1::Coupling::EXPLICIT);
  coupling.set_predictor(v1::Coupling::CONSTANT);
  try {
    double largest = 0;
    for (const auto& accepted : march_piston(added_mass, TimeRule::backward, coupling, 2, step).steps) {
      largest = std::max(largest, std::abs(accepted.state.motion(1)));
    }
    return largest;
  } catch (const report::NumericsError&) {
    return INFINITY;
  }
}

// With the motion of the last step given to the flow, accelerations obey a_{n+1} = -(m_a / m_s) a_n as dt -> 0:
// explicit coupling is stable below m_a / m_s = 1 and unstable above, for every step [Causin, Gerbeau, Nobile 2005].
TEST(ExplicitPiston, IsStableBelowAddedMassNumberOne) {
  for (const double added_mass : {0.01, 0.1, 0.5, 0.9}) {
    for (const double step : {1e-2, 1e-3}) {
      EXPECT_LT(largest_explicit_displacement(added_mass, step), 2) << added_mass;  // the exact amplitude is below 1.4
    }
  }
}

TEST(ExplicitPiston, FailsAboveAddedMassNumberOneForEveryStep) {
  for (const double added_mass : {1.1, 2., 10., 100.}) {
    for (const double step : {1e-2, 1e-3}) {
      EXPECT_GT(largest_explicit_displacement(added_mass, step), 100) << added_mass << " " << step;
    }
  }
}

TEST(ExplicitPiston, SaysWhatToDoWhenItFails) {
  v1::Coupling coupling;
  coupling.set_scheme(v1::Coupling::EXPLICIT);
  coupling.set_predictor(v1::Coupling::CONSTANT);
  try {
    march_piston(100, TimeRule::backward, coupling, 2, 1e-3);
    FAIL() << "an unstable run was accepted";
  } catch (const report::NumericsError& failure) {
    EXPECT_NE(failure.advice().find("SERIAL_IMPLICIT"), std::string::npos) << failure.what();
  }
}

}  // namespace
}  // namespace couplet::oracle
