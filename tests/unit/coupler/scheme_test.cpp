#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "coupler/convergence/criterion.hpp"
#include "coupler/convergence/level_guard.hpp"
#include "coupler/scheme/interface_layout.hpp"
#include "coupler/scheme/step_size.hpp"
#include "proto/report/failure.hpp"
#include "tests/oracle/coupled_march.hpp"
#include "tests/oracle/piston.hpp"

namespace couplet::coupling {
namespace {

using Eigen::VectorXd;
using participant::Opened;
using surface::NodeArray;
using testing::HasSubstr;

TEST(Criterion, MeasuresTheLargestNodeAndTheWholeField) {
  VectorXd before = VectorXd::Zero(6), after(6);
  after << 3, 4, 0, 0, 0, 1;  // two nodes of three components
  const FieldChange change = measure_change(before, after, 3);
  EXPECT_DOUBLE_EQ(change.absolute, 5);
  EXPECT_DOUBLE_EQ(change.relative, 1);
}

TEST(Criterion, HoldsWhenEitherLimitHolds) {
  const Criterion both{"force", 1e-3, 1e-5};
  EXPECT_TRUE(has_converged(both, {1e-4, 1}));
  EXPECT_TRUE(has_converged(both, {1, 1e-6}));
  EXPECT_FALSE(has_converged(both, {1, 1}));
}

TEST(Criterion, AFieldThatStaysZeroHasConverged) {
  EXPECT_TRUE(has_converged({"force", {}, 1e-5}, measure_change(VectorXd::Zero(3), VectorXd::Zero(3), 3)));
}

TEST(Criterion, NotANumberHasNotConverged) {
  const VectorXd good = VectorXd::Zero(3), bad = VectorXd::Constant(3, NAN), vast = VectorXd::Constant(3, INFINITY);
  EXPECT_FALSE(has_converged({"force", 1e300, 0.9}, measure_change(good, bad, 3)));
  EXPECT_FALSE(has_converged({"force", 1e300, 0.9}, measure_change(vast, vast, 3)));
}

TEST(LevelGuard, RefusesValuesThatOverflowedAndStoppedChanging) {
  LevelGuard guard({{"force", "N", 1, 0, 2}});
  const VectorXd accepted = VectorXd::Ones(2);
  guard.start_step();
  EXPECT_FALSE(guard.check(VectorXd::Constant(2, 3), accepted));
  EXPECT_FALSE(guard.check(VectorXd::Constant(2, 300), accepted));
  EXPECT_FALSE(guard.check(VectorXd::Constant(2, 3), accepted));
  EXPECT_THAT(guard.check(VectorXd::Constant(2, 1e8), accepted).value_or(""), HasSubstr("force changed by"));
  EXPECT_THAT(guard.check(VectorXd::Constant(2, NAN), accepted).value_or(""), HasSubstr("not a finite number"));
}

TEST(LevelGuard, LetsASuddenLoadPass) {
  LevelGuard guard({{"force", "N", 1, 0, 2}});
  guard.start_step();
  EXPECT_FALSE(guard.check(VectorXd::Constant(2, 1e-9), VectorXd::Zero(2)));
  guard.accept(VectorXd::Constant(2, 1e-9), VectorXd::Zero(2));
  guard.start_step();
  EXPECT_FALSE(guard.check(VectorXd::Constant(2, 1e3), VectorXd::Constant(2, 1e-9)));
}

TEST(StepSize, ReachesTheEndByMultiplesOfTheStep) {
  StepSize size(1, 0.1, 6);
  int n = 0;
  for (; !size.is_at_end(); ++n) {
    EXPECT_DOUBLE_EQ(size.time(), 0.1 * n);
    size.accept(true);
  }
  EXPECT_EQ(n, 10);
  EXPECT_EQ(size.time(), 1);
}

TEST(StepSize, CutsTheLastStepAtTheEnd) {
  StepSize size(0.25, 0.1, 6);
  size.accept(true), size.accept(true);
  EXPECT_DOUBLE_EQ(size.duration(), 0.05);
  size.accept(true);
  EXPECT_EQ(size.time(), 0.25);
}

TEST(StepSize, JoinsWhatARoundedStepLeavesToTheLastStep) {
  StepSize size(1, 0.3333, 6);  // three steps end at 0.9999
  size.accept(true);
  EXPECT_EQ(size.duration(), 0.3333);
  size.accept(true);
  EXPECT_EQ(size.next_time(), 1);
  EXPECT_NEAR(size.duration(), 0.3334, 1e-12);
  size.accept(true);
  EXPECT_TRUE(size.is_at_end());
}

TEST(StepSize, HalvesAndGrowsBackToMultiplesOfTheStep) {
  StepSize size(1, 0.1, 6);
  size.accept(true);
  EXPECT_TRUE(size.halve());
  EXPECT_TRUE(size.halve());
  EXPECT_DOUBLE_EQ(size.duration(), 0.025);
  while (size.level() > 0) size.accept(true);
  const double in_steps = size.time() / 0.1;
  EXPECT_NEAR(in_steps, std::round(in_steps), 1e-12);  // a whole step starts at a multiple of itself
  EXPECT_DOUBLE_EQ(size.duration(), 0.1);
}

TEST(StepSize, StaysSmallWhileStepsAreHard) {
  StepSize size(1, 0.1, 6);
  size.halve();
  for (int k = 0; k < 8; ++k) size.accept(false);
  EXPECT_EQ(size.level(), 1);
}

TEST(StepSize, KnowsItsFloor) {
  StepSize size(1, 0.1, 2);
  EXPECT_TRUE(size.halve());
  EXPECT_TRUE(size.halve());
  EXPECT_FALSE(size.halve());
  EXPECT_DOUBLE_EQ(size.duration(), 0.025);
}

Opened offering(std::vector<std::string> needs, std::vector<std::string> offers) {
  Opened opened;
  opened.surface.node_position = NodeArray::Zero(2, 3);
  opened.needs = std::move(needs);
  opened.offers = offers;
  for (const std::string& name : offers) opened.fields.push_back({name, "1", NodeArray::Zero(2, 3)});
  return opened;
}

TEST(InterfaceLayout, LetsDisplacementDetermineAndVelocityFollow) {
  const InterfaceLayout layout = make_interface_layout(offering({"velocity", "displacement"}, {"force"}),
                                                       offering({"force"}, {"displacement", "velocity"}));
  EXPECT_EQ(layout.motion[0].name, "displacement");
  EXPECT_EQ(layout.motion[1].name, "velocity");
  EXPECT_EQ(layout.n_primary_motion, 6);
  EXPECT_EQ(layout.n_motion(), 12);
}

TEST(InterfaceLayout, RefusesANeedThatNobodyOffers) {
  try {
    make_interface_layout(offering({"temperature"}, {"force"}), offering({"force"}, {"displacement"}));
    FAIL();
  } catch (const report::SceneError& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("the flow needs the field 'temperature', but the solid offers displacement"));
  }
}

/// A piston flow that can be told to misbehave at some solves.
class MoodyFlow : public oracle::PistonFlow {
 public:
  using Mood = std::function<void(const participant::StepInterval&, surface::FieldSet&)>;
  MoodyFlow(double added_mass, Mood mood)
      : PistonFlow(oracle::one_piston(added_mass), oracle::TimeRule::trapezoidal), mood_(std::move(mood)) {}
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    participant::StepSolved solved = PistonFlow::solve_step(interval, fields);
    mood_(interval, solved.fields);
    return solved;
  }

 private:
  Mood mood_;
};

oracle::CoupledMarch march_moody(const MoodyFlow::Mood& mood, v1::Coupling coupling = {}) {
  MoodyFlow flow(1, mood);
  oracle::PistonSolid solid(oracle::one_piston(1), oracle::TimeRule::trapezoidal);
  return oracle::march(flow, solid, coupling, 1, 0.1);
}

TEST(TimeLoop, TriesAgainWithHalfTheStepWhenAStepDiverges) {
  const auto run = march_moody([](const participant::StepInterval& interval, surface::FieldSet& fields) {
    if (interval.start > 0.25 && interval.start < 0.35 && interval.duration > 0.03) fields[0].values.setConstant(NAN);
  });
  EXPECT_EQ(run.n_discarded, 2);
  EXPECT_DOUBLE_EQ(run.steps[3].duration, 0.025);
  EXPECT_DOUBLE_EQ(run.steps.back().time, 1);
  EXPECT_DOUBLE_EQ(run.steps.back().duration, 0.1);  // grown back
}

TEST(TimeLoop, TriesAgainWithHalfTheStepWhenASolverGivesUp) {
  const auto run = march_moody([](const participant::StepInterval& interval, surface::FieldSet&) {
    if (interval.start > 0.25 && interval.duration > 0.06) throw report::NumericsError("element 7", "is inverted");
  });
  EXPECT_GE(run.n_discarded, 1);
  EXPECT_DOUBLE_EQ(run.steps.back().time, 1);
}

TEST(TimeLoop, NeverAcceptsWhatIsNotANumber) {
  for (const auto scheme : {v1::Coupling::EXPLICIT, v1::Coupling::SERIAL_IMPLICIT, v1::Coupling::PARALLEL_IMPLICIT}) {
    v1::Coupling coupling;
    coupling.set_scheme(scheme);
    coupling.set_halvings_max(1);
    const auto spoil = [](const participant::StepInterval& interval, surface::FieldSet& fields) {
      if (interval.start > 0.25) fields[0].values(0, 1) = NAN;
    };
    EXPECT_THROW(march_moody(spoil, coupling), report::NumericsError);
  }
}

TEST(TimeLoop, SaysWhereASolverGaveUpForGood) {
  try {
    march_moody([](const participant::StepInterval& interval, surface::FieldSet&) {
      if (interval.start > 0.25) throw report::NumericsError("element 7", "is inverted");
    });
    FAIL();
  } catch (const report::NumericsError& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("step 4 from t = 0.3 s by dt = 0.0015625 s"));
    EXPECT_THAT(failure.what(), HasSubstr("element 7: is inverted"));
  }
}

TEST(TimeLoop, PassesOnThatAPeerIsLost) {
  EXPECT_THROW(march_moody([](const participant::StepInterval& interval, surface::FieldSet&) {
                 if (interval.start > 0.25) throw report::PeerError("flow", "is gone");
               }),
               report::PeerError);
}

TEST(ExplicitStep, SolvesEachSideOncePerStep) {
  int n_solves = 0;
  v1::Coupling coupling;
  coupling.set_scheme(v1::Coupling::EXPLICIT);
  const auto count = [&n_solves](const participant::StepInterval&, surface::FieldSet& fields) {
    ++n_solves;
    fields[0].values.setZero();
  };
  const auto run = march_moody(count, coupling);
  EXPECT_EQ(n_solves, 10);
  EXPECT_EQ(run.iterations_mean(), 1);
}

TEST(ConstantRelaxation, RelaxesTheForceBeforeTheSolidSeesIt) {
  // Pistons without stiffness or added mass, a force of 1 from nowhere: the first iteration moves the solid by 0.9 of
  // it.
  v1::Coupling coupling;
  coupling.mutable_constant();
  v1::Convergence* criterion = coupling.add_convergence();
  criterion->set_field("force");
  criterion->set_relative(2e-3);
  oracle::PistonRow row = oracle::one_piston(0);
  MoodyFlow flow(0, [](const participant::StepInterval&, surface::FieldSet& fields) { fields[0].values(0, 1) = 1; });
  oracle::PistonSolid solid(row, oracle::TimeRule::trapezoidal);
  const auto run = oracle::march(flow, solid, coupling, 0.1, 0.1);
  EXPECT_EQ(run.steps.size(), 1u);
  EXPECT_EQ(run.steps[0].iterations, 4);  // 1 - 0.1^k is within 2e-3 of 1 when k = 3; the fourth iteration sees it
}

TEST(Convergence, RefusesAFieldThatIsNotExchanged) {
  v1::Coupling coupling;
  v1::Convergence* criterion = coupling.add_convergence();
  criterion->set_field("temperature");
  criterion->set_relative(1e-3);
  try {
    march_moody([](const participant::StepInterval&, surface::FieldSet&) {}, coupling);
    FAIL();
  } catch (const report::SceneError& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("'temperature' is not exchanged; exchanged: displacement, velocity, force"));
  }
}

}  // namespace
}  // namespace couplet::coupling
