#include "solid-server/dynamics/newton.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid-server/dynamics/one_spring.hpp"

namespace couplet::solid {
namespace {

const NodeVectors nothing = NodeVectors::Zero(1, 4);

/// u + u^3 = 10 at u = 2.
OneSpring hardening() {
  OneSpring spring;
  spring.spring = [](double u) { return u + u * u * u; };
  spring.stiffness = [](double u) { return 1 + 3 * u * u; };
  spring.load = 10;
  return spring;
}

TEST(Newton, FindsTheSolutionWithNewFactorsWhereOldOnesConvergeTooSlowly) {
  OneSpring spring = hardening();
  spring.cost_of_factors = 0;
  NodeVectors u = nothing;
  const NewtonReport report = Newton({1e-10}).solve(spring, u, nothing);
  EXPECT_TRUE(report.has_converged());
  EXPECT_NEAR(u(0, 0), 2, 1e-9);
  EXPECT_GT(report.n_factorisations, 1);
  EXPECT_LE(report.n_iterations, 10);  // of second order; from 10, the first step's end, 6 halvings of u come first
  EXPECT_EQ(report.n_factorisations, spring.n_factorisations);
}

TEST(Newton, KeepsFactorsThatAreDear) {
  OneSpring spring = hardening();
  spring.cost_of_factors = 1000;
  NodeVectors u = OneSpring::on_x(1.9);
  const NewtonReport report = Newton({1e-10}).solve(spring, u, nothing);
  EXPECT_TRUE(report.has_converged());
  EXPECT_EQ(report.n_factorisations, 1);
  EXPECT_NEAR(u(0, 0), 2, 1e-9);
  EXPECT_LE(report.n_iterations, 6);  // with one unknown the updates make it the secant method
}

TEST(Newton, ShortensStepsThatWouldOvershoot) {
  // atan(u) = 0: full steps from beyond 1.39 go further out every time.
  OneSpring spring;
  spring.spring = [](double u) { return std::atan(u) + 1; };
  spring.stiffness = [](double u) { return 1 / (1 + u * u); };
  spring.load = 1;
  NodeVectors u = OneSpring::on_x(20);
  const NewtonReport report = Newton({1e-10}).solve(spring, u, nothing);
  EXPECT_TRUE(report.has_converged()) << report.sentence();
  EXPECT_NEAR(u(0, 0), 0, 1e-9);
}

TEST(Newton, TakesAnInvertedElementForInfiniteEnergy) {
  OneSpring spring = hardening();
  spring.inverted_above = 3;  // the first step would end at 10
  NodeVectors u = nothing;
  EXPECT_TRUE(Newton({1e-10}).solve(spring, u, nothing).has_converged());
  EXPECT_NEAR(u(0, 0), 2, 1e-9);

  spring.inverted_above = -1;
  u = nothing;
  const NewtonReport report = Newton({}).solve(spring, u, nothing);
  EXPECT_EQ(report.outcome, NewtonOutcome::inverted_element);
  EXPECT_EQ(report.inverted_element, 7);
  EXPECT_NE(report.sentence().find("element 7"), std::string::npos);
}

TEST(Newton, SaysThatForcesAreNotFinite) {
  OneSpring spring = hardening();
  spring.spring = [](double u) { return u == 0 ? 0 : std::exp(1e3 / std::abs(u)) * std::exp(1e3); };
  NodeVectors u = nothing;
  const NewtonReport report = Newton({1e-10}).solve(spring, u, nothing);
  EXPECT_EQ(report.outcome, NewtonOutcome::not_finite) << report.sentence();
  EXPECT_EQ(report.inverted_element, -1);
}

TEST(Newton, SaysThatThereIsNoSolutionAndLeavesTheStart) {
  OneSpring spring;  // a spring that bears no more than 1
  spring.spring = [](double u) { return u / std::sqrt(1 + u * u); };
  spring.stiffness = [](double u) { return std::pow(1 + u * u, -1.5); };
  spring.load = 2;
  NodeVectors u = OneSpring::on_x(0.5);
  const NewtonReport report = Newton({}).solve(spring, u, nothing);
  EXPECT_FALSE(report.has_converged());
  EXPECT_EQ(u(0, 0), 0.5);
  EXPECT_FALSE(report.sentence().empty());
}

TEST(Newton, StopsWhereForcesCannotBeBalancedAnyBetter) {
  OneSpring spring = hardening();
  const auto exact = spring.spring;
  spring.spring = [exact](double u) { return exact(u) + (u > 1.999 ? 1e-9 : 0); };  // noise above the tolerance
  spring.stiffness = [](double u) { return (1 + 3 * u * u) * (u > 1.9999 ? 1e8 : 1); };
  NodeVectors u = nothing;
  EXPECT_TRUE(Newton({1e-14}).solve(spring, u, nothing).has_converged());
}

}  // namespace
}  // namespace couplet::solid
