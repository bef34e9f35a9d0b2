#include "flow-server/service/make_navier_stokes.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "flow-server/service/estimate_flow.hpp"
#include "flow-server/service/make_flow_model.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string axes = R"(x { uniform { start: 0 end: 2 cells: 8 } } y { faces { face: [0, 0.1, 0.3, 0.6, 1] } })";

v1::Scene scene_with(const std::string& model, const std::string& grid = axes) {
  v1::Scene scene;
  const std::string text =
      "title: \"t\" time { end: 1 step: 0.1 } flow { fluid { density: 2 viscosity: 0.5 } "
      "navier_stokes { grid { " +
      grid + " } " + model + " } }";
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &scene)) << text;
  return scene;
}

NavierStokesOptions made_from(const std::string& model, const std::string& grid = axes) {
  return make_navier_stokes(scene_with(model, grid), "/scenes");
}

/// The velocity that is prescribed on the last patch of a border.
Point velocity_on(const NavierStokesSetup& setup, int direction, int side, const Point& at, double t) {
  const auto& patches = setup.border[static_cast<std::size_t>(direction)][static_cast<std::size_t>(side)];
  const VectorValue& value = std::get<PrescribedVelocity>(patches.back().condition).velocity;
  return {value[0].at(at, t), value[1].at(at, t), value[2].at(at, t)};
}

TEST(MakeNavierStokes, MakesAGridOfTwoDimensions) {
  const NavierStokesSetup setup = made_from("", axes + " depth: 0.2").setup;
  EXPECT_EQ(setup.grid.n_dimensions, 2);
  EXPECT_EQ(setup.grid.n_cells(), (Triple{8, 4, 1}));
  EXPECT_EQ(setup.grid.axis[2].length(), 0.2);
  EXPECT_EQ(setup.density, 2);
  EXPECT_EQ(setup.viscosity, 0.5);
}

TEST(MakeNavierStokes, MeasuresMomentumAndMomentsThatAreNamed) {
  const std::string bodies =
      "body { name: 'a' cylinder { radius: 0.1 } } body { name: 'b' cylinder { radius: 0.1 } moment_about { at { x: 3 "
      "} "
      "carried: true } } ";
  const FlowObservation observed = made_from(bodies + "momentum_balance { name: 'box' box { x_to: 1.1 } }").observed;
  ASSERT_EQ(observed.balances.size(), 1u);
  EXPECT_EQ(observed.balances[0].name, "box");
  EXPECT_EQ(observed.balances[0].to[0], 1.1);
  ASSERT_EQ(observed.moments.size(), 1u);
  EXPECT_EQ(observed.moments[0].body, 1u);
  EXPECT_EQ(observed.moments[0].about[0], 3);
  EXPECT_TRUE(observed.moments[0].is_carried);
  EXPECT_EQ(observed.regions.at(0).quantities.back(), FieldQuantity::fluid_share);
  EXPECT_NE(made_from("").observed.regions.at(0).quantities.back(), FieldQuantity::fluid_share);
  try {
    made_from("momentum_balance { name: 'box' box { x_from: 0.5 x_to: 1.1 } }");
    FAIL() << "made of too few cells";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("flow.navier_stokes.momentum_balance 'box'"));
    EXPECT_THAT(error.what(), HasSubstr("has 2 cells along x"));
  }
}

TEST(MakeNavierStokes, MakesStretchedAndPeriodicAxes) {
  const NavierStokesSetup setup = made_from("", R"(
    x { stretched { start: 0 end: 4 region { start: 1 end: 2 width: 0.1 } largest_growth: 1.2 largest_width: 0.5 } }
    y { uniform { start: -1 end: 1 cells: 6 } periodic: true } z { uniform { start: 0 end: 1 cells: 4 } })")
                                      .setup;
  EXPECT_EQ(setup.grid.n_dimensions, 3);
  EXPECT_NEAR(setup.grid.axis[0].smallest_width(), 0.1, 1e-12);
  // What is left of the length, at most half a cell, is shared among the cells that grow.
  EXPECT_LE(setup.grid.axis[0].largest_width(), 0.5 * 1.2);
  EXPECT_LE(setup.grid.axis[0].largest_growth(), 1.25);
  EXPECT_TRUE(setup.grid.axis[1].is_periodic());
  EXPECT_TRUE(setup.border[1][0].empty());
}

TEST(MakeNavierStokes, ABorderThatIsLeftOutIsAWallAtRest) {
  const NavierStokesSetup setup = made_from("").setup;
  EXPECT_EQ(velocity_on(setup, 0, 1, {2, 0.5, 0}, 0.3), (Point{0, 0, 0}));
}

TEST(MakeNavierStokes, MakesEveryCondition) {
  const NavierStokesSetup setup = made_from(R"(border {
    x_start { velocity { expression { x: "y*t" } } }
    x_end { pressure { in_time { row { time: 0 value: 5 } row { time: 1 value: 7 } } } }
    y_start { slip_wall { } }
    y_end { no_slip_wall { velocity { x: 3 } }
            patch { name: "vent" box { x_from: 1 } convective_outflow { } } } })")
                                      .setup;
  EXPECT_EQ(velocity_on(setup, 0, 0, {0, 0.5, 0}, 3), (Point{1.5, 0, 0}));
  EXPECT_EQ(std::get<PressureOpening>(setup.border[0][1].back().condition).pressure.at({}, 0.5), 6);
  EXPECT_TRUE(std::holds_alternative<SlipWall>(setup.border[1][0].back().condition));
  ASSERT_EQ(setup.border[1][1].size(), 2u);
  EXPECT_TRUE(std::holds_alternative<ConvectiveOutflow>(setup.border[1][1][1].condition));
  EXPECT_EQ(setup.border[1][1][1].from[0], 1);
  EXPECT_TRUE(std::isinf(setup.border[1][1][1].to[0]));
}

TEST(MakeNavierStokes, ATableTimesADirectionKeepsToThatDirection) {
  const NavierStokesSetup setup = made_from(R"(body_force { in_time {
    table { row { time: 0 value: 1 } row { time: 1 value: 3 } } direction { x: 2 y: -1 } } })")
                                      .setup;
  EXPECT_EQ(setup.body_force[0].at({}, 0.5), 4);
  EXPECT_EQ(setup.body_force[1].at({}, 0.5), -2);
  EXPECT_FALSE(setup.body_force[2].varies_in_time());
}

TEST(MakeNavierStokes, AnExactStartHasItsPressure) {
  const NavierStokesSetup setup = made_from("initial { exact { taylor_green { velocity: 3 } } }").setup;
  EXPECT_NEAR(setup.initial_velocity[0].at({0.5 * M_PI, 0, 0}, 0), 3, 1e-12);
  EXPECT_NEAR(setup.initial_pressure.at({0, 0, 0}, 0), 0.25 * 2 * 9 * 2, 1e-12);  // rho V^2 / 4 (1 + 1)
}

TEST(MakeNavierStokes, FluidIsWhereTheFormulaIsPositive) {
  const NavierStokesSetup setup = made_from("fluid_where: \"y - 0.5\"").setup;
  EXPECT_TRUE(setup.is_fluid({0, 0.6, 0}));
  EXPECT_FALSE(setup.is_fluid({0, 0.4, 0}));
}

TEST(MakeNavierStokes, AFormulaThatIsNoNumberIsLeftToTheFlowToRefuse) {
  // A rank that threw here alone would leave the others waiting.
  const NavierStokesSetup setup = made_from("border { x_start { velocity { expression { x: \"1/y\" } } } }").setup;
  EXPECT_FALSE(std::isfinite(velocity_on(setup, 0, 0, {0, 0, 0}, 0.25)[0]));
}

TEST(MakeNavierStokes, StoredRegionsHoldTheCellsWithTheirCentreInTheBox) {
  const NavierStokesOptions options = made_from(R"(
    field { name: "near" box { x_from: 0.5 x_to: 1.5 y_to: 0.5 } stride: 2 quantity: [Q_CRITERION] precision: DOUBLE })");
  ASSERT_EQ(options.observed.regions.size(), 1u);
  const FieldRegion& region = options.observed.regions[0];
  EXPECT_EQ(region.cells, (Box{{2, 0, 0}, {6, 3, 1}}));
  EXPECT_EQ(region.stride, 2);
  EXPECT_THAT(region.quantities, ElementsAre(FieldQuantity::q_criterion));
  EXPECT_EQ(region.precision, Precision::full);
  EXPECT_THROW(made_from("field { box { x_from: 0.51 x_to: 0.6 } }"), report::SceneError);
}

TEST(MakeNavierStokes, WithoutFieldsVelocityAndPressureOfAllAreStored) {
  const NavierStokesOptions options = made_from("");
  ASSERT_EQ(options.observed.regions.size(), 1u);
  EXPECT_EQ(options.observed.regions[0].name, "flow");
  EXPECT_EQ(options.observed.regions[0].cells, box_of({8, 4, 1}));
  EXPECT_THAT(options.observed.regions[0].quantities, ElementsAre(FieldQuantity::velocity, FieldQuantity::pressure));
}

TEST(MakeNavierStokes, TakesMethodAndLimits) {
  const NavierStokesOptions options = made_from(R"(time_scheme: CRANK_NICOLSON courant_number: 0.7 smallest_step: 1e-6
    largest_step: 0.02 balances_inflow: true decomposition { x: 2 }
    pressure { method: MULTIGRID relative_tolerance: 1e-6 largest_iterations: 9 } initial { file: "start.h5" })");
  EXPECT_EQ(options.setup.scheme, TimeScheme::crank_nicolson);
  EXPECT_EQ(options.setup.step.courant, 0.7);
  EXPECT_EQ(options.setup.step.smallest, 1e-6);
  EXPECT_EQ(options.setup.step.largest, 0.02);
  EXPECT_TRUE(options.setup.balances_inflow);
  EXPECT_EQ(options.setup.pressure.method, PressureMethod::multigrid);
  EXPECT_EQ(options.setup.pressure.relative_tolerance, 1e-6);
  EXPECT_EQ(options.setup.pressure.largest_iterations, 9);
  EXPECT_EQ(*options.shape, (Triple{2, 1, 1}));
  EXPECT_EQ(options.initial_file, "/scenes/start.h5");
  EXPECT_TRUE(std::isnan(made_from("").setup.step.courant));
}

TEST(MakeNavierStokes, NeedsMpi) {
  try {
    make_flow_model(scene_with(""), "", {}, MPI_COMM_NULL);
    FAIL() << "was not refused";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run it by flow-server"));
  }
}

TEST(EstimateFlow, CountsCellsAndLimits) {
  participant::OpenRequest request;
  request.scene = scene_with("fluid_where: \"1 - x\" border { y_end { no_slip_wall { velocity { x: 4 } } } }");
  std::map<std::string, double> numbers;
  for (const auto& number : estimate_flow(request)) numbers[number.name] = number.value;
  EXPECT_EQ(numbers["cells"], 32);
  EXPECT_EQ(numbers["cells_active"], 16);
  EXPECT_NEAR(numbers["smallest_cell"], 0.1, 1e-12);
  EXPECT_NEAR(numbers["convective_step_limit"], 0.1 / 4, 1e-12);
  // dt nu (1/hx^2 + 1/hy^2) <= 1/2 with nu = 0.25
  EXPECT_NEAR(numbers["explicit_diffusion_step_limit"], 0.5 / (0.25 * (16 + 100)), 1e-12);
  EXPECT_GT(numbers["seconds_per_solve"], 0);
  EXPECT_GT(numbers["memory_bytes"], 0);
}

TEST(EstimateFlow, RefusesASurfaceWithAHoleBeforeARun) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "/pyramid_with_a_hole.obj") << "v 0.2 0.2 0.2\nv 0.4 0.2 0.2\nv 0.2 0.4 0.2\nv 0.2 0.2 0.4\n"
                                                     << "f 1 3 2\nf 1 2 4\nf 1 4 3\n";
  participant::OpenRequest request;
  request.scene_folder = folder;
  request.scene = scene_with("body { name: 'pyramid' file { file: 'pyramid_with_a_hole.obj' kind: CLOSED } }",
                             axes + " z { uniform { start: 0 end: 1 cells: 4 } }");
  try {
    estimate_flow(request);
    FAIL() << "a hole was not seen";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("surface 'pyramid'"), HasSubstr("has a hole: the edge from (")));
  }
}

TEST(MakeNavierStokes, TakesBodies) {
  const NavierStokesOptions options = made_from("body { name: 'rod' cylinder { radius: 0.1 } }");
  ASSERT_EQ(options.bodies.size(), 1u);
  EXPECT_EQ(options.bodies.front().name, "rod");
}

}  // namespace
}  // namespace couplet::flow
