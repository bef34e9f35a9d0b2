#include "flow-server/navier_stokes/step_limit.hpp"

#include <gtest/gtest.h>

namespace couplet::flow {
namespace {

TEST(StepLimit, IsTheCourantNumberOverTheRateWithoutViscosity) {
  StepLimits limits;
  EXPECT_DOUBLE_EQ(longest_step(TimeScheme::runge_kutta, {10, 0}, limits), 0.12);
  limits.courant = 0.5;
  EXPECT_DOUBLE_EQ(longest_step(TimeScheme::runge_kutta, {10, 0}, limits), 0.05);
  limits.largest = 0.01;
  EXPECT_DOUBLE_EQ(longest_step(TimeScheme::runge_kutta, {10, 0}, limits), 0.01);
}

TEST(StepLimit, OfDiffusionIsThatOfTheThreeDimensionalStencil) {
  const StretchedAxis axis(uniform_faces(0, 1, 10), true);
  const StretchedGrid grid{{axis, axis, axis}, 3};
  EXPECT_NEAR(diffusion_rate(grid, 0.01), 0.01 * 12 * 100, 1e-10);
  const StretchedAxis walls(uniform_faces(0, 1, 10), false);
  EXPECT_NEAR(diffusion_rate({{axis, walls, axis}, 2}, 0.01), 0.01 * (4 + 16.0 / 3) * 100, 1e-10);
  // Crank-Nicolson does not care.
  EXPECT_EQ(longest_step(TimeScheme::crank_nicolson, {0, 1e9}, {}), std::numeric_limits<double>::infinity());
}

TEST(StepLimit, PlansEqualStepsAndNoMoreThanNeeded) {
  const StepPlan plan = plan_steps(TimeScheme::runge_kutta, {10, 0}, {}, 0.36);
  EXPECT_EQ(plan.n_steps, 3);
  EXPECT_EQ(plan_steps(TimeScheme::runge_kutta, {10, 0}, {}, 0.361).n_steps, 4);
  EXPECT_EQ(plan_steps(TimeScheme::runge_kutta, {0, 0}, {}, 5).n_steps, 1);
}

TEST(StepLimit, ChoosesTheSchemeOfLeastCost) {
  const auto choice = [](double courant, double diffusion) {
    return plan_steps(TimeScheme::automatic, {courant, diffusion}, {}, 1).scheme;
  };
  EXPECT_EQ(choice(0.2, 0.01), TimeScheme::adams_bashforth);  // one short step: one evaluation is enough
  EXPECT_EQ(choice(1.1, 0.01), TimeScheme::runge_kutta);
  EXPECT_EQ(choice(10, 0.1), TimeScheme::runge_kutta);
  EXPECT_EQ(choice(1, 100), TimeScheme::crank_nicolson);  // diffusion would force 43 steps of Runge-Kutta
}

}  // namespace
}  // namespace couplet::flow
