#include "flow-server/immersed/immersed_bodies.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

using Flow = std::function<double(const Point&, int component)>;

/// Largest |net outflow| of a part of a cell, over the area of a face of the cell, of a flow that the walls take part
/// in; the velocities beside walls are those that WallForcing leaves.
double largest_outflow(int n, std::vector<BodySurface> surfaces, const Flow& flow) {
  const double h = 1.0 / n;
  for (BodySurface& surface : surfaces)
    for (std::size_t c = 0; c < surface.position.size(); ++c)
      for (int d = 0; d < 3; ++d) surface.velocity[c][static_cast<std::size_t>(d)] = flow(surface.position[c], d);
  PlacedBodies placed(uniform_box({n, n, n}, h), surfaces);
  placed.set_velocity(flow);
  // Inside bodies nothing is to be taken from; the forcing writes what it needs there.
  for (int d = 0; d < 3; ++d)
    PlacedBodies::visit(box_of(placed.block.sizes).grown(placed.block.ghosts), [&](const Triple& face) {
      double& u = placed.velocity[d](face[0], face[1], face[2]);
      if (std::isnan(u)) u = 1e3;
    });
  ImmersedBodies bodies(placed.block, BodyFlowSettings{});
  bodies.forcing().force(*placed.bodies, *placed.bodies, placed.pressure, placed.fill_from_neighbours(),
                         placed.velocity);
  bodies.forcing().take_slopes_of(*placed.bodies, 0, placed.pressure, placed.velocity);
  Field<double> source = placed.block.new_field();
  std::vector<double> piece_source;
  bodies.take_divergence(*placed.bodies, h, placed.velocity, bodies.forcing().piece_velocity(), source, piece_source);
  double largest = 0;
  for (const CutCell& cell : placed.bodies->cut().cells()) {
    const auto& [i, j, k] = cell.cell;
    // Faces beyond the border have no velocity here.
    if (std::min({i, j, k}) < 2 || std::max({i, j, k}) > n - 3) continue;
    largest = std::max(largest, std::abs(source(i, j, k)));
  }
  for (std::size_t p = 0; p < piece_source.size(); ++p) {
    const auto& [i, j, k] = placed.bodies->pieces().split().cell[p];
    if (std::min({i, j, k}) >= 2 && std::max({i, j, k}) <= n - 3)
      largest = std::max(largest, std::abs(piece_source[p]));
  }
  return largest;
}

double uniform(const Point&, int d) {
  return d == 0 ? 1 : d == 1 ? -0.6 : 0.3;
}

const Point middle{0.513, 0.487, 0.501};

TEST(ImmersedBodies, AUniformFlowThatTheWallsGoAlongWithHasNoDivergence) {
  // Areas close each part to round-off, whatever the walls are.
  EXPECT_LT(largest_outflow(16, {sphere_surface(middle, 0.3, 4)}, uniform), 1e-13);
  EXPECT_LT(largest_outflow(16, {flat_sheet({1.9, -1, -1}, {-1.3, 3, 0}, {-0.9, 0, 3}, 7)}, uniform), 1e-13);
  // Two sheets in one layer of cells, and a sphere beside them.
  EXPECT_LT(largest_outflow(16,
                            {flat_sheet({0.11, -1, -1}, {0.2, 3, 0}, {0, 0, 3}, 7),
                             flat_sheet({0.14, -1, -1}, {0.2, 3, 0}, {0, 0, 3}, 7), sphere_surface(middle, 0.2, 4)},
                            uniform),
            1e-13);
}

TEST(ImmersedBodies, TellWhetherThePressureProblemHasChanged) {
  const StretchedGrid grid = uniform_box({12, 12, 12}, 1.0 / 12);
  const auto sheet_at = [](double x) {
    return std::vector<BodySurface>{flat_sheet({x, -1, -1}, {0.2, 3, 0}, {0, 0, 3}, 7)};
  };
  PlacedBodies first(grid, sheet_at(0.4)), second(grid, sheet_at(0.4));
  ImmersedBodies bodies(first.block, BodyFlowSettings{});
  PressureProblem problem = make_pressure_problem(first.setup, first.block, first.border);
  const auto write = [&](const PlacedBodies& placed) {
    std::vector<Box> changed;
    return bodies.write_problem(*placed.bodies, problem, changed);
  };
  EXPECT_TRUE(write(first));
  EXPECT_FALSE(write(second));  // another geometry of the same place
  second.bodies->place(sheet_at(0.41));
  EXPECT_TRUE(write(second));
  EXPECT_TRUE(write(first));
}

}  // namespace
}  // namespace couplet::flow
