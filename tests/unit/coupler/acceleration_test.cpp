#include <gtest/gtest.h>

#include <Eigen/QR>
#include <functional>
#include <memory>

#include "coupler/acceleration/aitken.hpp"
#include "coupler/acceleration/constant_relaxation.hpp"
#include "coupler/acceleration/iqn_ils.hpp"
#include "coupler/acceleration/iqn_imvj.hpp"

namespace couplet::coupling {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x = G(x) = x* + J (x - x*).
struct LinearProblem {
  MatrixXd jacobian;
  VectorXd solution;

  VectorXd answer(const VectorXd& x) const { return solution + jacobian * (x - solution); }
};

/// Eigenvalues -mu from smallest to largest in a random orthonormal basis: what added mass looks like.
LinearProblem added_mass_problem(Eigen::Index n, double smallest_mu, double largest_mu) {
  std::srand(7);
  const MatrixXd basis = Eigen::HouseholderQR<MatrixXd>(MatrixXd::Random(n, n)).householderQ();
  const VectorXd mu = VectorXd::LinSpaced(n, smallest_mu, largest_mu);
  return {-basis * mu.asDiagonal() * basis.transpose(), VectorXd::Random(n)};
}

struct Solution {
  int iterations = 0;  // evaluations of G
  double residual = 0;
  double largest_residual = 0;
  VectorXd input, output;
};

Solution solve(Acceleration& acceleration, const LinearProblem& problem, VectorXd x, double tolerance,
               int iterations_max) {
  Solution solution;
  acceleration.start_step();
  for (solution.iterations = 1;; ++solution.iterations) {
    solution.input = x;
    solution.output = problem.answer(x);
    solution.residual = (solution.output - x).norm();
    solution.largest_residual = std::max(solution.largest_residual, solution.residual);
    if (!(solution.residual > tolerance) || solution.iterations == iterations_max) return solution;
    x = acceleration.next_input(x, solution.output);
  }
}

using Factory = std::function<std::unique_ptr<Acceleration>(InterfaceSize)>;
struct Member {
  std::string name;
  Factory make;
};

class EveryAcceleration : public testing::TestWithParam<Member> {
 protected:
  static std::unique_ptr<Acceleration> make(Eigen::Index n) { return GetParam().make({n, n}); }
};

INSTANTIATE_TEST_SUITE_P(
    All, EveryAcceleration,
    testing::Values(
        Member{"constant",
               [](InterfaceSize size) {
                 return std::make_unique<ConstantRelaxation>(VectorXd::Constant(size.n_total, 0.3));
               }},
        Member{"aitken", [](InterfaceSize size) { return std::make_unique<Aitken>(size, std::nullopt); }},
        Member{"iqn_ils", [](InterfaceSize size) { return std::make_unique<IqnIls>(size, QuasiNewtonOptions{}); }},
        Member{"iqn_imvj", [](InterfaceSize size) { return std::make_unique<IqnImvj>(size, QuasiNewtonOptions{}); }}),
    [](const auto& member) { return member.param.name; });

TEST_P(EveryAcceleration, SolvesLinearFixedPoint) {
  const LinearProblem problem = added_mass_problem(8, 0.1, 3);
  const auto acceleration = make(8);
  const Solution solution = solve(*acceleration, problem, VectorXd::Zero(8), 1e-9, 200);
  EXPECT_LE(solution.residual, 1e-9);
  EXPECT_LT((solution.output - problem.solution).norm(), 1e-8);  // |J| <= 3 enlarges the error of the residual
}

TEST_P(EveryAcceleration, KeepsTheSolutionWhenTheResidualIsZero) {
  const LinearProblem problem = added_mass_problem(8, 0.1, 3);
  const auto acceleration = make(8);
  acceleration->start_step();
  VectorXd x = problem.solution;
  for (int k = 0; k < 3; ++k) x = acceleration->next_input(x, x);
  EXPECT_EQ((x - problem.solution).norm(), 0);
  acceleration->accept_step(x, x);
}

TEST_P(EveryAcceleration, SurvivesTheSamePairTwice) {
  const LinearProblem problem = added_mass_problem(8, 0.1, 3);
  const auto acceleration = make(8);
  acceleration->start_step();
  const VectorXd x = VectorXd::Zero(8);
  const VectorXd once = acceleration->next_input(x, problem.answer(x));
  const VectorXd twice = acceleration->next_input(x, problem.answer(x));
  EXPECT_TRUE(once.allFinite());
  EXPECT_TRUE(twice.allFinite());
  EXPECT_LE(solve(*acceleration, problem, twice, 1e-9, 200).residual, 1e-9);
}

TEST_P(EveryAcceleration, TakesNoDifferencesAcrossSteps) {
  // A jump of the solution between two steps is no answer of G: if a difference were taken across it, G(x) - x at equal
  // x would seem to change by itself.
  LinearProblem problem = added_mass_problem(8, 0.1, 3);
  const auto acceleration = make(8);
  const Solution first = solve(*acceleration, problem, VectorXd::Zero(8), 1e-9, 200);
  acceleration->accept_step(first.input, first.output);
  problem.solution += VectorXd::Constant(8, 5);
  const Solution second = solve(*acceleration, problem, first.input, 1e-9, 200);
  EXPECT_LE(second.residual, 1e-9);
  EXPECT_LE(second.iterations, first.iterations + first.iterations / 5);  // another start, the same difficulty
}

TEST_P(EveryAcceleration, SolvesAfterAStepWasThrownAway) {
  const auto acceleration = make(8);
  const LinearProblem wild = added_mass_problem(8, 50, 400), mild = added_mass_problem(8, 0.1, 3);
  solve(*acceleration, wild, VectorXd::Zero(8), 1e-9, 5);
  acceleration->discard_step();
  EXPECT_LE(solve(*acceleration, mild, VectorXd::Zero(8), 1e-9, 2000).residual, 1e-9);
}

TEST_P(EveryAcceleration, ContinuesWithEqualBitsAfterRestore) {
  const LinearProblem problem = added_mass_problem(8, 0.1, 3);
  const auto straight = make(8);
  const Solution first = solve(*straight, problem, VectorXd::Zero(8), 1e-6, 200);
  straight->accept_step(first.input, first.output);
  SavedState state;
  straight->save(state);
  const auto resumed = make(8);
  resumed->restore(state);
  LinearProblem next = problem;
  next.solution *= 1.1;
  const Solution a = solve(*straight, next, first.input, 1e-6, 200), b = solve(*resumed, next, first.input, 1e-6, 200);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.output, b.output);
}

class EveryQuasiNewton : public EveryAcceleration {};
INSTANTIATE_TEST_SUITE_P(
    All, EveryQuasiNewton,
    testing::Values(
        Member{"iqn_ils", [](InterfaceSize size) { return std::make_unique<IqnIls>(size, QuasiNewtonOptions{}); }},
        Member{"iqn_imvj", [](InterfaceSize size) { return std::make_unique<IqnImvj>(size, QuasiNewtonOptions{}); }}),
    [](const auto& member) { return member.param.name; });

TEST_P(EveryQuasiNewton, IsExactOnceTheDifferencesSpanTheSpace) {
  for (const Eigen::Index n : {1, 2, 4}) {
    const LinearProblem problem = added_mass_problem(n, 0.5, 2);
    const auto acceleration = make(n);
    // n + 1 iterations give n differences; the input after them is the solution up to round-off, which the conditioning
    // of a few differences enlarges.
    const Solution solution = solve(*acceleration, problem, VectorXd::Zero(n), 1e-8, static_cast<int>(n) + 2);
    EXPECT_LE(solution.residual, 1e-8) << n;
  }
}

TEST_P(EveryQuasiNewton, SolvesVeryStrongAddedMassWithoutAGivenRelaxation) {
  const LinearProblem problem = added_mass_problem(30, 1, 300);
  const auto acceleration = make(30);
  const Solution solution = solve(*acceleration, problem, VectorXd::Zero(30), 1e-6, 60);
  EXPECT_LE(solution.residual, 1e-6);
}

TEST(IqnIls, NeverLetsTheResidualRunAway) {
  for (const double mu : {10., 100., 1000.}) {
    const LinearProblem problem = added_mass_problem(30, mu / 2, mu);
    IqnIls acceleration({30, 30}, {});
    const Solution solution = solve(acceleration, problem, VectorXd::Zero(30), 1e-6, 80);
    EXPECT_LE(solution.residual, 1e-6) << mu;
    // The first residual is about mu |x*|; plain relaxation by 1 would multiply it by mu in every iteration.
    EXPECT_LT(solution.largest_residual, 100 * mu * problem.solution.norm()) << mu;
  }
}

TEST(IqnIls, IsNotSlowForWeakCoupling) {
  const LinearProblem problem = added_mass_problem(30, 0.001, 0.003);
  IqnIls acceleration({30, 30}, {});
  const Solution first = solve(acceleration, problem, VectorXd::Zero(30), 1e-6, 80);
  acceleration.accept_step(first.input, first.output);
  EXPECT_LE(first.iterations, 5);  // the probe and one more than relaxation by 1 needs: 0.003^k
  LinearProblem next = problem;
  next.solution.reverseInPlace();
  EXPECT_LE(solve(acceleration, next, first.input, 1e-6, 80).iterations, 4);
}

TEST(IqnIls, ReusesDifferencesOfEarlierSteps) {
  LinearProblem problem = added_mass_problem(10, 1, 30);
  IqnIls reusing({10, 10}, {}), forgetting({10, 10}, {50, 0, 1e-3, std::nullopt});
  int iterations_reusing = 0, iterations_forgetting = 0;
  VectorXd x = VectorXd::Zero(10);
  for (int step = 0; step < 5; ++step) {
    const Solution a = solve(reusing, problem, x, 1e-8, 100), b = solve(forgetting, problem, x, 1e-8, 100);
    reusing.accept_step(a.input, a.output);
    forgetting.accept_step(b.input, b.output);
    iterations_reusing = a.iterations, iterations_forgetting = b.iterations;
    problem.solution = VectorXd::Random(10);
  }
  EXPECT_LE(iterations_reusing, 3);  // all directions are known: one evaluation, one correction, one to see it
  EXPECT_GT(iterations_forgetting, 8);
}

TEST(IqnIls, LetsSecondaryEntriesFollowWithTheSameCombination) {
  // The secondary entries are the primary ones times 7 in input and output alike; then they must stay so.
  const LinearProblem problem = added_mass_problem(6, 0.5, 20);
  IqnIls acceleration({6, 12}, {});
  acceleration.start_step();
  VectorXd x = VectorXd::Zero(12);
  for (int k = 0; k < 12; ++k) {
    VectorXd y(12);
    y << problem.answer(x.head(6)), 7 * problem.answer(x.head(6));
    x = acceleration.next_input(x, y);
    EXPECT_LT((x.tail(6) - 7 * x.head(6)).norm(), 1e-10 * x.norm()) << k;  // round-off
  }
  EXPECT_LT((x.head(6) - problem.solution).norm(), 1e-6);
}

TEST(IqnIls, EstimatesTheAddedMassNumber) {
  const LinearProblem problem = added_mass_problem(5, 39, 41);
  IqnIls acceleration({5, 5}, {});
  solve(acceleration, problem, VectorXd::Zero(5), 1e-6, 50);
  EXPECT_NEAR(acceleration.added_mass_number(), 40, 1);  // a Rayleigh quotient lies between the extreme eigenvalues
}

TEST(IqnIls, KeepsNoMoreColumnsThanAllowed) {
  const LinearProblem problem = added_mass_problem(40, 1, 50);
  IqnIls acceleration({40, 40}, {5, 100, 1e-6, std::nullopt});
  VectorXd x = VectorXd::Zero(40);
  for (int step = 0; step < 4; ++step) {
    const Solution solution = solve(acceleration, problem, x, 1e-12, 20);
    acceleration.accept_step(solution.input, solution.output);
    SavedState state;
    acceleration.save(state);
    EXPECT_LE(state.at("columns").cols(), 5);
  }
}

TEST(Aitken, FindsTheFactorOfASingleDirectionAtOnce) {
  const LinearProblem problem = added_mass_problem(1, 9, 9);
  Aitken acceleration({1, 1}, std::nullopt);
  EXPECT_LE(solve(acceleration, problem, VectorXd::Zero(1), 1e-10, 4).residual, 1e-10);
}

TEST(ConstantRelaxation, TakesAFactorForEachEntry) {
  ConstantRelaxation acceleration(Eigen::Vector2d(1.0, 0.7));
  EXPECT_EQ(acceleration.next_input(Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)), Eigen::Vector2d(1.0, 0.7));
}

}  // namespace
}  // namespace couplet::coupling
