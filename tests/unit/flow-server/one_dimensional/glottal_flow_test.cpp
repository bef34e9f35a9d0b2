#include "flow-server/one_dimensional/glottal_flow.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/one_dimensional/every_glottal_model.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;

constexpr int n_stations = 60;
constexpr double width = 0.02;  // [m]

GlottalLaw law_of(GlottalModel model) {
  GlottalLaw law{.model = model, .density = 1.13, .viscosity = 2.27e-4};
  if (model == GlottalModel::m1 || model == GlottalModel::m2) {
    law.friction_coefficient = 2;
    law.smallest_recovery = 0.5;
  }
  if (model == GlottalModel::m2) law.entrance_contraction = 0.25;
  return law;
}

/// A throat of the given gap at 80 % of the way, 20 mm wide open at the inlet.
SectionProfile throat(const StationAxis& axis, double gap, double exit = 0.012) {
  SectionProfile profile;
  profile.exit = exit;
  profile.contraction_start = 0.5 * exit;
  profile.area = width * (gap + 0.02 * ((axis.fraction() - 0.8) / 0.8).square());
  profile.perimeter = 2 * (width + profile.area / width);
  return profile;
}

class EveryGlottalModel : public ::testing::TestWithParam<GlottalModel> {
 protected:
  const StationAxis axis{n_stations};
  GlottalFlow flow{axis, law_of(GetParam())};
};

TEST_P(EveryGlottalModel, MeetsBothEndPressures) {
  flow.start(throat(axis, 4e-4), {1000, -100});
  for (int step = 1; step <= 20; ++step) {
    const GlottalSolution& now = flow.solve(throat(axis, 4e-4 + 1e-5 * step), {1000.0 + 10 * step, -100}, 1e-5);
    EXPECT_EQ(now.pressure[0], 1000.0 + 10 * step);
    // A sum of 60 drops of up to some kPa each.
    EXPECT_NEAR(now.pressure[n_stations - 1], -100, 1e-9);
    EXPECT_FALSE(now.clipped);
    flow.accept();
  }
}

TEST_P(EveryGlottalModel, WhatFlowsInFlowsOutOrFillsTheGrowingVolume) {
  for (const auto derivative : {TimeDerivative::backward_euler, TimeDerivative::bdf2}) {
    GlottalLaw law = law_of(GetParam());
    law.time_derivative = derivative;
    GlottalFlow moving(axis, law);
    moving.start(throat(axis, 4e-4), {1000, 0});
    double step = 1e-5;
    for (int n = 1; n <= 30; ++n) {
      const GlottalHistory before = moving.history();
      moving.solve(throat(axis, 4e-4 + 2e-4 * std::sin(0.3 * n), 0.012 + 3e-4 * std::sin(0.2 * n)), {1000, 0}, step);
      moving.accept();
      const GlottalSolution& now = moving.history().accepted;
      const bool has_earlier = derivative == TimeDerivative::bdf2 && before.has_earlier;
      const BackwardDifference rate = backward_difference(step, before.previous_step, has_earlier);
      const auto change = [&](double f, double old, double older) {
        return rate.now * f + rate.before * old + rate.earlier * older;
      };
      for (int k = 0; k < n_stations; ++k) {
        const double growth = change(now.volume[k], before.accepted.volume[k], before.earlier.volume[k]);
        const double speed = axis.fraction()[k] * change(now.exit, before.accepted.exit, before.earlier.exit);
        const double out = now.effective_area[k] * (now.velocity[k] - speed);
        // Round-off of volumes times 1/step.
        EXPECT_NEAR(now.inlet_rate - growth - out, 0, 1e-14 * (std::abs(now.inlet_rate) + now.volume[k] / step));
      }
      step *= n % 2 == 0 ? 0.5 : 2;
    }
  }
}

TEST_P(EveryGlottalModel, SolvingAStepAgainGivesEqualBits) {
  flow.start(throat(axis, 4e-4), {1000, -100});
  for (int step = 0; step < 3; ++step) {
    const GlottalSolution first = flow.solve(throat(axis, 3e-4), {1100, -100}, 1e-5);
    flow.solve(throat(axis, 8e-4), {500, -100}, 3e-5);
    const GlottalSolution again = flow.solve(throat(axis, 3e-4), {1100, -100}, 1e-5);
    EXPECT_EQ(first.inlet_rate, again.inlet_rate);
    EXPECT_TRUE((first.pressure == again.pressure).all());
    EXPECT_TRUE((first.velocity == again.velocity).all());
    flow.accept();
  }
}

TEST_P(EveryGlottalModel, ContinuesFromARestoredHistoryWithEqualBits) {
  flow.start(throat(axis, 4e-4), {1000, -100});
  for (int step = 1; step <= 5; ++step) {
    flow.solve(throat(axis, 4e-4 + 1e-5 * step), {1000, -100}, 1e-5 * step);
    flow.accept();
  }
  GlottalFlow resumed(axis, law_of(GetParam()));
  resumed.restore(flow.history());
  for (int step = 6; step <= 10; ++step) {
    const GlottalSolution& a = flow.solve(throat(axis, 4e-4 + 1e-5 * step), {1000, -100}, 1e-5);
    const GlottalSolution& b = resumed.solve(throat(axis, 4e-4 + 1e-5 * step), {1000, -100}, 1e-5);
    EXPECT_TRUE((a.pressure == b.pressure).all());
    EXPECT_EQ(a.exit_rate, b.exit_rate);
    flow.accept();
    resumed.accept();
  }
}

TEST_P(EveryGlottalModel, StaysFiniteWhileTheGlottisSlamsShutAndOpens) {
  flow.start(throat(axis, 1e-3), {1000, 0});
  for (int step = 1; step <= 200; ++step) {
    const double gap = std::max(1e-6, 1e-3 * std::cos(0.1 * step));
    const GlottalSolution& now = flow.solve(throat(axis, gap), {1000, 0}, 1e-5);
    EXPECT_TRUE(now.pressure.allFinite() && now.velocity.allFinite());
    flow.accept();
  }
}

TEST_P(EveryGlottalModel, NothingFlowsWithoutPressureAndMotion) {
  flow.start(throat(axis, 4e-4), {0, 0});
  flow.solve(throat(axis, 4e-4), {0, 0}, 1e-5);
  flow.accept();
  // The three weights of the time derivative add up to zero but for round-off: 1e-16 of a volume of 1e-6 m^3 in 1e-5 s.
  EXPECT_NEAR(flow.history().accepted.inlet_rate, 0, 1e-16);
  EXPECT_LT(flow.history().accepted.pressure.abs().maxCoeff(), 1e-9);
}

TEST_P(EveryGlottalModel, SteadyFlowIsAFixedPointOfTheUnsteadyEquations) {
  const SectionProfile profile = throat(axis, 4e-4);
  flow.start(profile, {1000, -100});
  const double steady = flow.history().accepted.inlet_rate;
  EXPECT_GT(steady, 0);
  for (int step = 0; step < 50; ++step) {
    flow.solve(profile, {1000, -100}, 1e-5);
    flow.accept();
  }
  EXPECT_NEAR(flow.history().accepted.inlet_rate, steady, 1e-11 * steady);
}

TEST_P(EveryGlottalModel, SaysWhereTheExitLineWentWhenItPassesTheInlet) {
  flow.start(throat(axis, 4e-4), {1000, 0});
  SectionProfile inverted = throat(axis, 4e-4);
  inverted.exit = -0.001;
  try {
    flow.solve(inverted, {1000, 0}, 1e-5);
    FAIL() << "accepted";
  } catch (const report::NumericsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the exit line has moved to x = -0.001 m"));
  }
}

TEST_P(EveryGlottalModel, ReportsThatItClippedWhenNoFlowFitsThePressures) {
  GlottalLaw law = law_of(GetParam());
  law.friction_coefficient = 0;
  law.unsteady = false;
  GlottalFlow steady(axis, law);
  steady.start(throat(axis, 4e-4), {0, 100});  // the exit pressure is the higher one: Bernoulli has no such flow
  EXPECT_TRUE(steady.history().accepted.clipped);
  EXPECT_EQ(steady.history().accepted.inlet_rate, 0);
}

INSTANTIATE_TEST_SUITE_P(Models, EveryGlottalModel, every_model, name_of_model);

TEST(GlottalFlow, B1HasTheExitPressureFromTheThroatOn) {
  const StationAxis axis(n_stations);
  GlottalFlow flow(axis, law_of(GlottalModel::b1));
  flow.start(throat(axis, 4e-4), {1000, -100});
  const GlottalSolution& now = flow.history().accepted;
  EXPECT_GT(now.throat, 0);
  EXPECT_LT(now.throat, n_stations - 1);
  for (int k = now.throat + 1; k < n_stations; ++k) EXPECT_EQ(now.pressure[k], -100);
  EXPECT_GT(now.pressure[now.throat - 5], -100);
}

TEST(GlottalFlow, B2AndM1WithoutLossesAreTheSame) {
  const StationAxis axis(n_stations);
  GlottalLaw lossless = law_of(GlottalModel::m1);
  lossless.friction_coefficient = 0;
  lossless.smallest_recovery = 1;
  GlottalFlow a(axis, law_of(GlottalModel::b2)), b(axis, lossless);
  a.start(throat(axis, 4e-4), {1000, -100});
  b.start(throat(axis, 4e-4), {1000, -100});
  EXPECT_TRUE((a.history().accepted.pressure == b.history().accepted.pressure).all());
}

TEST(GlottalFlow, M2WithoutContractionIsM1) {
  const StationAxis axis(n_stations);
  GlottalLaw plain = law_of(GlottalModel::m2);
  plain.entrance_contraction = 0;
  GlottalFlow a(axis, plain), b(axis, law_of(GlottalModel::m1));
  a.start(throat(axis, 4e-4), {1000, -100});
  b.start(throat(axis, 4e-4), {1000, -100});
  EXPECT_TRUE((a.history().accepted.pressure == b.history().accepted.pressure).all());
}

TEST(GlottalFlow, EffectiveAreaFallsFromOneAtTheEntranceToOneMinusC1AtTheExit) {
  const StationAxis axis(n_stations);
  GlottalFlow flow(axis, law_of(GlottalModel::m2));
  const SectionProfile profile = throat(axis, 4e-4);
  flow.start(profile, {1000, -100});
  const GlottalSolution& now = flow.history().accepted;
  for (int k = 0; k < n_stations; ++k) {
    const double x = now.position[k], xa = 0.006, xb = 0.012;
    const double alpha = x < xa ? 1 : 0.75 + 0.25 * (x - xb) * (x - xb) / ((xa - xb) * (xa - xb));
    EXPECT_NEAR(now.effective_area[k], alpha * profile.area[k], 1e-15 * profile.area[k] + 1e-18);
  }
}

TEST(GlottalFlow, FrictionOfTheConvergingPartLeavesTheRestAlone) {
  const StationAxis axis(n_stations);
  GlottalLaw law = law_of(GlottalModel::m1);
  law.friction_only_where_converging = true;
  law.smallest_recovery = 0;  // then nothing but friction can change the pressure downstream of the throat
  GlottalFlow flow(axis, law);
  flow.start(throat(axis, 4e-4), {1000, -100});
  const GlottalSolution& now = flow.history().accepted;
  for (int k = now.throat; k < n_stations; ++k) EXPECT_NEAR(now.pressure[k], -100, 1e-9);
}

// Two throats of nearly equal width: which is the narrower one decides only the pressure between them.
TEST(GlottalFlow, FlowIsContinuousWhenTheThroatJumps) {
  const StationAxis axis(n_stations);
  const auto pressure_with = [&](double second_throat) {
    SectionProfile profile = throat(axis, 4e-4);
    for (int k = 0; k < n_stations; ++k) {
      const double xi = axis.fraction()[k];
      const double first = 4e-4 + 4e-3 * (xi - axis.fraction()[20]) * (xi - axis.fraction()[20]);
      const double second = second_throat + 4e-3 * (xi - axis.fraction()[45]) * (xi - axis.fraction()[45]);
      profile.area[k] = width * std::min(first, second);
    }
    GlottalFlow flow(axis, law_of(GlottalModel::m1));
    flow.start(profile, {1000, -100});
    return flow.history().accepted;
  };
  const double change = 1e-9;  // [m] of the second throat: it is the wider one, then the narrower one
  const GlottalSolution before = pressure_with(4e-4 + change), after = pressure_with(4e-4 - change);
  ASSERT_GT(std::abs(before.throat - after.throat), 10);
  // Twice the change is 5e-6 of the gap; a pressure of 1 kPa may answer by some hundredths of a pascal, not by
  // hundreds.
  const Eigen::ArrayXd change_of_pressure = (before.pressure - after.pressure).abs();
  EXPECT_LT(change_of_pressure.head(20).maxCoeff(), 0.1);
  EXPECT_LT(change_of_pressure.tail(n_stations - 46).maxCoeff(), 0.1);
  EXPECT_NEAR(before.inlet_rate, after.inlet_rate, 1e-4 * before.inlet_rate);
  EXPECT_GT(change_of_pressure.maxCoeff(), 10);  // losses behind the first throat or not
}

TEST(GlottalFlow, QuasiSteadyFlowForgetsWhatWasBefore) {
  const StationAxis axis(n_stations);
  GlottalLaw law = law_of(GlottalModel::m2);
  law.unsteady = false;
  GlottalFlow moved(axis, law), fresh(axis, law);
  moved.start(throat(axis, 9e-4), {300, 0});
  moved.solve(throat(axis, 4e-4, 0.0125), {1000, -100}, 1e-5);
  moved.accept();
  fresh.start(throat(axis, 4e-4, 0.0125), {1000, -100});
  EXPECT_TRUE((moved.history().accepted.pressure == fresh.history().accepted.pressure).all());
}

TEST(GlottalFlow, RefusesAChannelThatOnlyWidens) {
  const StationAxis axis(n_stations);
  GlottalFlow flow(axis, law_of(GlottalModel::b1));
  SectionProfile profile = throat(axis, 4e-4);
  profile.area = 1e-5 * (1 + axis.fraction());
  EXPECT_THROW(flow.start(profile, {1000, 0}), report::NumericsError);
}

}  // namespace
}  // namespace couplet::flow
