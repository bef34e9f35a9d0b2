// Started on 1 and 2 ranks.
#include "flow-server/output/surface_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "flow-server/immersed/body_loads.hpp"
#include "flow-server/output/field_writer.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"
#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;

constexpr int n = 16;
constexpr double h = 1.0 / n;

/// Surfaces in a box of fluid with a pressure, as a part of a flow; without viscosity.
struct PressedBodies {
  PressedBodies(std::vector<BodySurface> surfaces, const std::function<double(const Point&)>& pressure)
      : placed(uniform_box({n, n, n}, h), std::move(surfaces), MPI_COMM_WORLD, {ranks_of_test(), 1, 1}) {
    placed.set_velocity([](const Point&, int) { return 0.0; });
    placed.set_pressure(pressure);
    state.velocity = std::move(placed.velocity);
    state.pressure = std::move(placed.pressure);
    state.bodies = std::move(placed.bodies);
    loads = BodyLoads(placed.block, 0).measure(state);
    for (const BodySurface& surface : state.bodies->surfaces()) {
      stored.push_back(stored_surface(surface));
      force.push_back(loads[force.size()].corner_force);
    }
  }

  FlowPart part() const { return {placed.setup.grid, placed.blocks, placed.block.cells, state}; }
  std::vector<SurfaceValues> measure() const { return measure_surfaces(part(), stored, loads, force); }

  PlacedBodies placed;
  FlowState state;
  std::vector<SurfaceLoad> loads;
  std::vector<StoredSurface> stored;
  std::vector<std::vector<Point>> force;
};

double linear(const Point& p) {
  return 3 + 2 * p[0] - p[1];
}

TEST(SurfaceResults, PressureOfABodyIsThatOfTheFluidBesideIt) {
  // Triangles a good deal larger than cells, and so much smaller that most corners move no crossing.
  for (const int n_cuts : {2, 6}) {
    const BodySurface ball = sphere_surface({0.52, 0.49, 0.51}, 0.3, n_cuts);
    const PressedBodies pressed({ball}, linear);
    const SurfaceValues values = pressed.measure().at(0);
    ASSERT_EQ(fields_of(pressed.stored[0]).at(3).name, "pressure");
    double worst = 0, traction = 0;
    for (std::size_t c = 0; c < ball.position.size(); ++c)
      worst = std::max(worst, std::abs(values[3][c] - linear(ball.position[c])));
    for (const double component : values[4]) traction = std::max(traction, std::abs(component));
    // A mean over walls within a triangle, or a cell, of the pressure in the middle of cells.
    const double reach = std::max(1.5 * h, 0.3 * std::numbers::pi / 2 / (1 << n_cuts));
    EXPECT_LT(worst, 2 * std::sqrt(5.0) * reach) << n_cuts;
    EXPECT_GT(worst, 0);
    EXPECT_LT(traction, 1e-10);  // no friction: what is left of a difference of forces, over small areas
  }
}

TEST(SurfaceResults, ASheetHasTwoSides) {
  const BodySurface sheet = flat_sheet({0.2, 0.503, 0.2}, {0, 0, 0.6}, {0.6, 0, 0}, 12);  // its outer side is y > 0.503
  const PressedBodies pressed({sheet}, [](const Point& p) { return p[1] > 0.503 ? 5.0 : 1.0; });
  // The larger parts of the cells that it cuts, with their middles, lie above it, the others below.
  std::fill(pressed.state.bodies->piece_pressure.begin(), pressed.state.bodies->piece_pressure.end(), 1.0);
  const SurfaceValues values = pressed.measure().at(0);
  const auto fields = fields_of(pressed.stored[0]);
  ASSERT_EQ(fields.at(3).name, "pressure_outer");
  ASSERT_EQ(fields.at(4).name, "pressure_inner");
  const auto at = [](double x) { return x > 0.2 + 1e-9 && x < 0.8 - 1e-9; };
  for (std::size_t c = 0; c < sheet.position.size(); ++c) {
    if (!at(sheet.position[c][0]) || !at(sheet.position[c][2])) continue;  // at its edge the sides mix
    EXPECT_NEAR(values[3][c], 5, 4) << c;
    EXPECT_GT(values[3][c], values[4][c]);
  }
  // In the middle, away from cells that the edge ends in, nothing of the other side.
  const std::size_t middle = 6 * 13 + 6;
  EXPECT_NEAR(values[3][middle], 5, 1e-12);
  EXPECT_NEAR(values[4][middle], 1, 1e-12);
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(SurfaceResults, LieWithTheFieldsOfTheirStateAndGoOnAfterAStop) {
  const SharedFolder folder("surface-results");
  BodySurface ball = sphere_surface({0.52, 0.49, 0.51}, 0.3, 2);
  ball.name = "ball";
  PressedBodies pressed({ball}, linear);
  const StretchedGrid& grid = pressed.placed.setup.grid;
  const FieldRegion region{
      "flow", box_of(grid.n_cells()), 1, {FieldQuantity::pressure, FieldQuantity::fluid_share}, Precision::single};
  const auto open = [&](double time, const std::vector<StoredSurface>& surfaces) {
    return FieldWriter(folder.path(), grid, pressed.placed.blocks, {region}, time, surfaces);
  };
  {
    FieldWriter writer = open(0, pressed.stored);
    for (const double time : {0.0, 0.25, 0.5}) {
      pressed.state.time = time;
      writer.append(pressed.part(), pressed.measure());
    }
  }
  {
    FieldWriter writer = open(0.25, pressed.stored);  // resumed from there: the state at 0.5 is dropped
    pressed.state.time = 0.75;
    writer.append(pressed.part(), pressed.measure());
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank_of_test() == 0) {
    const auto file = store::Hdf5File::open_for_reading(folder.path() / "flow.h5");
    EXPECT_EQ(file.read_integers("body/ball/triangle").size(), 3 * ball.triangle.size());
    const surface::NodeArray position = file.read("state/000002/body/ball/position");
    ASSERT_EQ(position.rows(), static_cast<Eigen::Index>(ball.position.size()));
    EXPECT_NEAR(position(7, 1), ball.position[7][1], 1e-7);  // single precision
    EXPECT_TRUE(file.contains("state/000002/body/ball/viscous_traction"));
    const std::string listing = text_of(folder.path() / "body.ball.xmf");
    EXPECT_THAT(listing, HasSubstr("<Time Value=\"0.75\"/>"));
    EXPECT_THAT(listing, testing::Not(HasSubstr("<Time Value=\"0.5\"/>")));
    EXPECT_THAT(listing, HasSubstr("TopologyType=\"Triangle\" NumberOfElements=\"128\""));
    EXPECT_THAT(listing, HasSubstr("flow.000002.h5:/body/ball/pressure"));
    EXPECT_FALSE(file.contains("state/000003/time"));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  std::vector<StoredSurface> other = pressed.stored;
  other[0].triangle.pop_back();
  EXPECT_THROW(open(0.75, other), report::FileError);
}

TEST(SurfaceResults, FluidSharesSumToTheVolumeOfTheFluid) {
  const double radius = 0.3, volume = 4 * std::numbers::pi / 3 * std::pow(radius, 3);
  const auto fluid_of = [](const PressedBodies& pressed) {
    double sum = 0;
    const Triple sizes = pressed.placed.block.sizes;
    for (int k = 0; k < sizes[2]; ++k)
      for (int j = 0; j < sizes[1]; ++j)
        for (int i = 0; i < sizes[0]; ++i) sum += fluid_share(pressed.part(), {i, j, k}) * h * h * h;
    return sum_of_ranks(sum);
  };
  const PressedBodies with_ball({sphere_surface({0.52, 0.49, 0.51}, radius, 5)}, linear);
  // Chords of the cells, 5 to a radius, lie inside the sphere by a few hundredths of a cell: measured 2.3 %.
  EXPECT_NEAR(fluid_of(with_ball), 1 - volume, 0.03 * volume);
  // A sheet takes no room, whatever it parts: parts of a cell sum to it, but for the 1e-9 by which surfaces are moved.
  const PressedBodies with_sheet({flat_sheet({0.2, 0.31, 0.2}, {0, 0.2, 0.6}, {0.6, 0.1, 0}, 12)}, linear);
  EXPECT_NEAR(fluid_of(with_sheet), 1, 1e-12);
}

TEST(SurfaceResults, EnergyIsThatOfTheFluidAlone) {
  const double radius = 0.3, volume = 4 * std::numbers::pi / 3 * std::pow(radius, 3);
  PressedBodies pressed({sphere_surface({0.52, 0.49, 0.51}, radius, 5)}, linear);
  for (int d = 0; d < 3; ++d)
    PlacedBodies::visit(box_of(pressed.placed.block.sizes).grown({1, 1, 1}),
                        [&](const Triple& face) { pressed.state.velocity[d](face[0], face[1], face[2]) = d + 1; });
  const double energy = sum_of_ranks(integrate(pressed.part(), 2, 0).kinetic_energy);
  EXPECT_NEAR(energy, 14 * (1 - volume), 14 * 0.03 * volume);  // rho/2 |u|^2, |u|^2 = 14; as exact as the volume
}

}  // namespace
}  // namespace couplet::flow
