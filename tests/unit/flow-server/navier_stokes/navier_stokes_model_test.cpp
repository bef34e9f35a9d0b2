// Started on 1, 2 and 4 ranks.
#include "flow-server/navier_stokes/navier_stokes_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/navier_stokes/step_limit.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A duct with an inlet profile that swells, an outflow, a wall that moves and a block in the way.
NavierStokesOptions duct(TimeScheme scheme, bool has_block) {
  NavierStokesOptions options{
      .setup = {stretched_box({16, 12, 8}, {false, false, true}), 1.2, 0.02, {}, {}, {}, {}, {}, scheme, {}, {}, false},
      .shape = {},
      .initial_file = {},
      .observed = {}};
  const SpaceTimeValue inlet([](const Point& x, double t) { return (1 - x[1] * x[1]) * (1 + 0.5 * std::sin(20 * t)); });
  FacePatch in, out, lid;
  in.condition = PrescribedVelocity{{inlet, SpaceTimeValue(0), SpaceTimeValue(0)}};
  out.condition = ConvectiveOutflow{};
  lid.condition = PrescribedVelocity{{SpaceTimeValue(0.3), SpaceTimeValue(0), SpaceTimeValue(0)}};
  options.setup.border[0] = {std::vector{in}, std::vector{out}};
  options.setup.border[1][1] = {lid};
  options.setup.initial_velocity = {SpaceTimeValue([](const Point& x, double) { return 1 - x[1] * x[1]; }),
                                    SpaceTimeValue(0), SpaceTimeValue(0)};
  if (has_block)
    options.setup.is_fluid = [](const Point& x) { return !(x[0] > 0.8 && x[0] < 1.2 && std::abs(x[1]) < 0.4); };
  options.observed.has_integrals = true;
  options.observed.planes = {{"cut", 0, 1.5, {-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}};
  options.observed.probes = {{"wake", {1.5, 0.1, 0.4}}};
  return options;
}

std::vector<double> take_steps(NavierStokesModel& model, int n_steps) {
  std::vector<double> values;
  for (int s = 0; s < n_steps; ++s) {
    model.solve_step(0.01, {});
    for (const FlowQuantity& quantity : model.accept_step()) values.push_back(quantity.value);
  }
  return values;
}

class EveryScheme : public testing::TestWithParam<std::tuple<TimeScheme, bool>> {
 protected:
  NavierStokesOptions options() const { return duct(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};

TEST(NavierStokesModel, FindsNoForceWhereThereIsNoBody) {
  NavierStokesOptions options = duct(TimeScheme::adams_bashforth, false);
  options.setup.pressure.relative_tolerance = 1e-8;
  options.observed.balances = {{"box", {0.3, -0.7, -infinity}, {1.6, 0.8, infinity}}};
  double largest[2] = {0, 0};
  for (const int level : {0, 1}) {
    const double dt = level == 0 ? 0.01 : 0.005;
    NavierStokesModel model(options, MPI_COMM_WORLD);
    for (int step = 0; step * dt < 0.1; ++step) {
      model.solve_step(dt, {});
      for (const FlowQuantity& quantity : model.accept_step())
        if (quantity.name.find("force_balance") != std::string::npos && step > 2)
          largest[level] = std::max(largest[level], std::abs(quantity.value));
    }
  }
  // The error is that of fluxes that are means of both ends of a step: second order. Momentum flows with about 1 N.
  EXPECT_GT(largest[0], 0);
  EXPECT_LT(largest[0], 2e-3);
  EXPECT_LT(largest[1], largest[0] / 3);
  options.observed.balances = {{"box", {0.3, 0.1, 0}, {1.6, 0.2, 1}}};
  EXPECT_THROW(NavierStokesModel(options, MPI_COMM_WORLD), report::SceneError);
}

TEST_P(EveryScheme, RepeatsAStepWithEqualBits) {
  NavierStokesModel model(options(), MPI_COMM_WORLD);
  take_steps(model, 2);
  model.solve_step(0.02, {});  // thrown away
  model.solve_step(0.01, {});
  const auto first = model.accept_step();
  NavierStokesModel other(options(), MPI_COMM_WORLD);
  take_steps(other, 2);
  other.solve_step(0.01, {});
  const auto second = other.accept_step();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].value, second[i].value) << first[i].name;
}

TEST_P(EveryScheme, ContinuesFromACheckpointWithEqualBits) {
  const SharedFolder folder("model-checkpoint");
  NavierStokesModel model(options(), MPI_COMM_WORLD);
  take_steps(model, 3);
  model.write_checkpoint(folder.path() / "flow.h5");
  const std::vector<double> expected = take_steps(model, 3);
  NavierStokesModel resumed(options(), MPI_COMM_WORLD);
  resumed.resume(folder.path() / "flow.h5");
  EXPECT_NEAR(resumed.time(), 0.03, 1e-15);
  EXPECT_EQ(take_steps(resumed, 3), expected);
}

TEST_P(EveryScheme, ContinuesOnOtherBlocks) {
  const SharedFolder folder("model-other-blocks");
  NavierStokesModel model(options(), MPI_COMM_WORLD);
  take_steps(model, 3);
  model.write_checkpoint(folder.path() / "flow.h5");
  const std::vector<double> expected = take_steps(model, 3);
  for (const Triple& shape : {Triple{ranks_of_test(), 1, 1}, Triple{1, ranks_of_test(), 1}}) {
    if (12 / shape[1] < smallest_block) continue;
    NavierStokesOptions other = options();
    other.shape = shape;
    NavierStokesModel resumed(other, MPI_COMM_WORLD);
    resumed.resume(folder.path() / "flow.h5");
    const std::vector<double> found = take_steps(resumed, 3);
    ASSERT_EQ(found.size(), expected.size());
    const std::size_t n = expected.size() / 3;
    for (std::size_t i = 0; i < found.size(); ++i) {
      // What is left of the residual and the divergence depends on how the solver's levels are cut.
      if (i % n == 3 || i % n == 5) continue;
      EXPECT_NEAR(found[i], expected[i], 1e-9 * (1 + std::abs(expected[i]))) << "quantity " << i % n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NavierStokesModel, EveryScheme,
                         testing::Combine(testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                                          TimeScheme::crank_nicolson),
                                          testing::Bool()),
                         [](const auto& test) {
                           return name_of(std::get<0>(test.param)) + (std::get<1>(test.param) ? "_with_a_block" : "");
                         });

/// A stream in two dimensions around an ellipse that moves by these joints.
NavierStokesOptions around_an_ellipse(const PlanePoint& centre, const std::array<double, 2>& radii,
                                      std::vector<Joint> joints) {
  const StretchedGrid grid{{StretchedAxis(uniform_faces(0, 3, 24), false),
                            StretchedAxis(uniform_faces(-1, 1, 16), false), StretchedAxis({0, 0.5}, false)},
                           2};
  NavierStokesOptions options{
      .setup = {grid, 1.2, 0.02, {}, {}, {}, {}, {}, TimeScheme::adams_bashforth, {}, {}, false},
      .shape = {},
      .initial_file = {},
      .observed = {}};
  FacePatch in, out;
  in.condition = PrescribedVelocity{{SpaceTimeValue(1), SpaceTimeValue(0), SpaceTimeValue(0)}};
  out.condition = ConvectiveOutflow{};
  options.setup.border[0] = {std::vector{in}, std::vector{out}};
  BodySetup bar;
  bar.name = "bar";
  bar.mesh = make_elliptic_cylinder(centre, radii, {0, 0.5, true}, 0.06);
  bar.motion = PrescribedMotion(std::move(joints));
  options.bodies = {bar};
  return options;
}

std::map<std::string, double> measures_of_a_bar(std::vector<Joint> joints, const FlowObservation::Moment& moment) {
  NavierStokesOptions options = around_an_ellipse({1.2, 0.1}, {0.45, 0.25}, std::move(joints));
  options.observed.moments = {moment};
  NavierStokesModel model(options, MPI_COMM_WORLD);
  std::map<std::string, double> found;
  for (int s = 0; s < 4; ++s) {
    model.solve_step(0.01, {});
    for (const FlowQuantity& quantity : model.accept_step()) found[quantity.name] = quantity.value;
  }
  return found;
}

TEST(NavierStokesModel, PowerIsThatOfForceAndMoment) {
  const TimeFormula turn{[](double t) { return 3 * t; }, 1e-3}, move{[](double t) { return 0.7 * t; }, 1e-3};
  const auto turning = measures_of_a_bar({Rotation{{1.5, 0.3, 0}, {0, 0, 1}, turn}}, {0, {1.5, 0.3, 0}, false});
  ASSERT_EQ(turning.count("body.bar.moment_z"), 1u);
  EXPECT_EQ(turning.count("body.bar.moment_x"), 0u);
  const double moment = turning.at("body.bar.moment_z");
  EXPECT_GT(std::abs(moment), 1e-3);
  EXPECT_NEAR(turning.at("body.bar.power"), 3 * moment, 1e-9 * std::abs(moment));  // the rate is a difference
  const auto moving = measures_of_a_bar({Translation{{move, 0.0, 0.0}}}, {0, {1.2, 0.1, 0}, false});
  const double force = moving.at("body.bar.force_x");
  EXPECT_NEAR(moving.at("body.bar.power"), 0.7 * force, 1e-9 * std::abs(force));
  // About a point that has been carried on by s: M' = M - s x F.
  const auto carried = measures_of_a_bar({Translation{{move, 0.0, 0.0}}}, {0, {1.2, 0.1, 0}, true});
  EXPECT_NEAR(carried.at("body.bar.moment_z"),
              moving.at("body.bar.moment_z") - 0.7 * 0.04 * moving.at("body.bar.force_y"), 1e-9 * std::abs(force));
  const auto fixed = measures_of_a_bar({}, {0, {1.2, 0.1, 0}, true});
  EXPECT_EQ(fixed.count("body.bar.power"), 0u);
}

TEST(NavierStokesModel, SaysOfBodiesThatTheGridDoesNotSee) {
  const auto refusal = [](const PlanePoint& centre, double radius) -> std::string {
    try {
      NavierStokesModel model(around_an_ellipse(centre, {radius, radius}, {}), MPI_COMM_WORLD);
    } catch (const report::SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({5, 0}, 0.2), AllOf(HasSubstr("lies outside the grid: it reaches from x = 4.79"),
                                          HasSubstr("m, the grid from 0 to 3 m")));
  EXPECT_THAT(refusal({1.5, 0}, 20), HasSubstr("encloses the grid and cuts it nowhere"));
  EXPECT_THAT(refusal({1.1, 0.06}, 0.01), HasSubstr("cuts no line between cells: it is at most 0.02"));
  EXPECT_EQ(refusal({1.5, 0}, 0.2), "");
  const TimeFormula into{[](double t) { return -t; }, 1e-3};
  const NavierStokesModel later(around_an_ellipse({5, 0}, {0.2, 0.2}, {Translation{{into, 0.0, 0.0}}}), MPI_COMM_WORLD);
  ASSERT_EQ(later.notes().size(), 1u);
  EXPECT_THAT(later.notes()[0], HasSubstr("body 'bar' at t = 0: lies outside the grid"));
}

TEST(NavierStokesModel, SaysWhereABodyLeaves) {
  const TimeFormula out{[](double t) { return 2 * t; }, 1e-3};
  NavierStokesModel model(around_an_ellipse({2.5, 0}, {0.2, 0.2}, {Translation{{out, 0.0, 0.0}}}), MPI_COMM_WORLD);
  try {
    take_steps(model, 20);
    FAIL() << "a body has left the grid";
  } catch (const report::NumericsError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("moves through an open border of the grid, x end at x = 3 m: it reaches to x = "));
  }
}

TEST(NavierStokesModel, NamesWhatItMeasures) {
  NavierStokesModel model(duct(TimeScheme::adams_bashforth, false), MPI_COMM_WORLD);
  model.solve_step(0.01, {});
  std::vector<std::string> names;
  for (const FlowQuantity& quantity : model.accept_step()) names.push_back(quantity.name);
  EXPECT_THAT(names, testing::ElementsAre("flow.substeps", "flow.courant", "flow.largest_speed", "flow.divergence",
                                          "flow.pressure_iterations", "flow.pressure_residual", "flow.kinetic_energy",
                                          "flow.dissipation", "flow.enstrophy", "cut.flow_rate", "cut.momentum_flux",
                                          "wake.velocity_x", "wake.velocity_y", "wake.velocity_z", "wake.pressure"));
}

TEST(NavierStokesModel, LetsAsMuchOutAsComesIn) {
  NavierStokesOptions options = duct(TimeScheme::adams_bashforth, true);
  options.setup.pressure.relative_tolerance = 1e-9;
  options.setup.pressure.divergence_tolerance = 0;
  options.observed.planes.push_back({"inlet", 0, 0, {-infinity, -infinity, -infinity}, {infinity, infinity, infinity}});
  NavierStokesModel model(options, MPI_COMM_WORLD);
  const std::vector<double> values = take_steps(model, 5);
  const std::size_t n = values.size() / 5;
  // Columns 9 and 11: flow rates of order 1; a 1e-9th of the divergence is left, in each of five steps.
  EXPECT_NEAR(values[4 * n + 9], values[4 * n + 11], 1e-8);
}

TEST(NavierStokesModel, StartsFromTheFlowOfAnotherRun) {
  const SharedFolder folder("model-start");
  NavierStokesModel model(duct(TimeScheme::adams_bashforth, false), MPI_COMM_WORLD);
  take_steps(model, 3);
  model.write_checkpoint(folder.path() / "flow.h5");
  NavierStokesOptions options = duct(TimeScheme::adams_bashforth, false);
  options.initial_file = folder.path() / "flow.h5";
  NavierStokesModel started(options, MPI_COMM_WORLD);
  EXPECT_EQ(started.time(), 0);
  const Triple sizes = model.decomposition().mine().sizes();
  EXPECT_EQ(started.state().velocity[1](sizes[0] / 2, sizes[1] / 2, 1),
            model.state().velocity[1](sizes[0] / 2, sizes[1] / 2, 1));
  EXPECT_NO_THROW(take_steps(started, 1));
}

TEST(NavierStokesModel, RefusesACheckpointOfAnotherGrid) {
  const SharedFolder folder("model-other-grid");
  NavierStokesModel model(duct(TimeScheme::adams_bashforth, false), MPI_COMM_WORLD);
  model.write_checkpoint(folder.path() / "flow.h5");
  NavierStokesOptions options = duct(TimeScheme::adams_bashforth, false);
  options.setup.grid = stretched_box({16, 12, 10}, {false, false, true});
  NavierStokesModel other(options, MPI_COMM_WORLD);
  try {
    other.resume(folder.path() / "flow.h5");
    FAIL() << "was not refused";
  } catch (const report::FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("its cells along z are not those of the scene"));
  }
}

TEST(NavierStokesModel, WantsOneBlockForEachRank) {
  NavierStokesOptions options = duct(TimeScheme::adams_bashforth, false);
  options.shape = {1, 1, ranks_of_test() + 1};
  EXPECT_THROW(NavierStokesModel(options, MPI_COMM_WORLD), report::SceneError);
}

TEST(NavierStokesModel, SharesCellsEvenlyAndInMultiplesOfCoarseCellsWhereThatCostsLittle) {
  const int n = ranks_of_test();
  const BlockDecomposition even = decompose(stretched_box({24, 8, 8}), Triple{n, 1, 1}, MPI_COMM_WORLD);
  EXPECT_EQ(even.mine().size(0), 24 / n);
  const BlockDecomposition coarse = decompose(stretched_box({100, 8, 8}), Triple{n, 1, 1}, MPI_COMM_WORLD);
  EXPECT_EQ(coarse.mine().begin[0] % 2, 0);
  EXPECT_LE(coarse.mine().size(0), (100 + n - 1) / n * 17 / 16);
}

TEST(NavierStokesModel, CountsItsCost) {
  NavierStokesModel model(duct(TimeScheme::adams_bashforth, true), MPI_COMM_WORLD);
  take_steps(model, 2);
  std::map<std::string, double> cost;
  for (const FlowQuantity& quantity : model.costs()) cost[quantity.name] = quantity.value;
  EXPECT_EQ(cost["cells"], 16 * 12 * 8);
  EXPECT_LT(cost["cells_active"], cost["cells"]);
  EXPECT_EQ(cost["ranks"], ranks_of_test());
  EXPECT_GE(cost["substeps"], 2);
  EXPECT_GT(cost["ns_per_cell_step"], 0);
  EXPECT_EQ(cost["messages_per_step"] > 0, ranks_of_test() > 1);
}

}  // namespace
}  // namespace couplet::flow
