// Narrow gaps: between sheets that close and part, between the edge of a sheet and a wall, and contact.

#include <gtest/gtest.h>

#include "flow-server/immersed/edge_clearance.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"
#include "tests/verification/moving_bodies.hpp"

namespace couplet::flow {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;

/// Two plates of length 1, inclined by 20 degrees, that drift through the grid and close from a gap of 4 cells to a
/// smaller one and open again within 2 s, smoothly also in their acceleration; in three dimensions they are squares.
struct ClosingPlates {
  int n = 20;               // cells to a length
  double smallest_gap = 1;  // [cells]
  double step = 0.005;      // [s]
  double until = 2;         // [s]
  int n_dimensions = 2;
  double box = 4;
};

std::vector<double> forces_on(const ClosingPlates& plates) {
  const double h = 1.0 / plates.n, angle = 20 * degree, box = plates.box;
  const bool is_flat = plates.n_dimensions == 2;
  const std::vector<double> faces = uniform_faces(0, box, static_cast<int>(std::lround(box * plates.n)));
  NavierStokesSetup setup =
      setup_on(box_grid({faces, faces, is_flat ? std::vector<double>{0, h} : faces}, {}, plates.n_dimensions),
               TimeScheme::adams_bashforth);
  setup.viscosity = 0.01;
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  const auto sheets = std::make_shared<EdgedSheets>(h, is_flat ? h : -1);
  setup.bodies = [=](double t) {
    const double mean = 0.5 * (4 + plates.smallest_gap) * h, swing = 0.5 * (4 - plates.smallest_gap) * h;
    const double gap = mean + swing * std::cos(pi * t), rate = -pi * swing * std::sin(pi * t);
    const std::array<double, 2> along{std::cos(angle), std::sin(angle)}, normal{-along[1], along[0]},
        middle{0.5 * box - 0.1 + 0.1 * t, 0.5 * box + 0.07 * t}, drift{0.1, 0.07};
    std::vector<BodySurface> surfaces;
    for (const double side : {-0.5, 0.5}) {
      const auto place = [&](double s, std::size_t d) { return middle[d] + s * along[d] + side * gap * normal[d]; };
      const std::array<double, 2> speed{drift[0] + side * rate * normal[0], drift[1] + side * rate * normal[1]};
      BodySurface plate;
      if (is_flat) {
        PlanePath path;
        for (int i = 0; i <= 4 * plates.n; ++i) {
          const double s = i / (4.0 * plates.n) - 0.5;
          path.place.push_back({place(s, 0), place(s, 1)});
          path.velocity.push_back(speed);
        }
        plate = prism_over(path, h, false);
      } else {
        plate = flat_sheet({place(-0.5, 0), place(-0.5, 1), 0.5 * box - 0.487}, {along[0], along[1], 0}, {0, 0, 1},
                           2 * plates.n);
        std::fill(plate.velocity.begin(), plate.velocity.end(), Point{speed[0], speed[1], 0});
      }
      surfaces.push_back(sheets->prolonged(surfaces.size(), plate));
    }
    return surfaces;
  };
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  return pressure_forces(flow, plates.step, static_cast<int>(std::lround(plates.until / plates.step)));
}

double largest(const std::vector<double>& force, std::size_t first) {
  double most = 0;
  for (std::size_t n = first; n < force.size(); ++n) most = std::max(most, std::abs(force[n]));
  return most;
}

TEST(NarrowGap, ForceOnClosingPlatesIsSmooth) {
  // Bounds: what was measured with half as much again, for other machines' round-off and order of sums.
  for (const auto& [gap, bound] : {std::pair{2.0, 0.0008}, {1.0, 0.005}}) {
    const double rough = roughness(forces_on({.smallest_gap = gap}), 10);
    RecordProperty("roughness_gap_" + std::to_string(static_cast<int>(gap)), std::to_string(rough));
    EXPECT_LT(rough, bound) << gap;
  }
}

TEST(NarrowGap, ForceDoesNotGrowWithTheNumberOfSteps) {
  // A wall whose velocity is imposed step by step in a gap of one cell is a resistance of density / step: the force
  // doubles with half the step. What is left is the error of a gap of one cell.
  const double force = largest(forces_on({.until = 1}), 10);
  const double finer = largest(forces_on({.step = 0.0025, .until = 1}), 20);
  RecordProperty("force", std::to_string(force));
  RecordProperty("force_with_half_the_step", std::to_string(finer));
  EXPECT_LT(finer, 1.4 * force);
}

TEST(NarrowGap, ForceOnClosingSquaresIsSmooth) {
  const double rough = roughness(forces_on({.n = 8, .smallest_gap = 1, .step = 0.02, .n_dimensions = 3, .box = 2}), 10);
  RecordProperty("roughness", std::to_string(rough));
  EXPECT_LT(rough, 0.005);
}

/// A channel of 3 x 1 (3 x 1 x 1) with a sheet of 27 degrees across it that leaves a gap to the floor, or to a closed
/// block on the floor; driven by 1 Pa from rest, without viscosity.
struct Valve {
  int n = 20;
  double gap = 0;     // [m]
  double offset = 0;  // of the sheet along the channel [cells]
  double block = 0;   // height of the block [m]
  int n_dimensions = 2;
};

/// dQ/dt per pressure and depth.
double conductance(const Valve& valve) {
  const double h = 1.0 / valve.n, angle = 27 * degree, floor = valve.block + valve.gap;
  const bool is_flat = valve.n_dimensions == 2;
  const std::vector<double> faces = uniform_faces(0, 1, valve.n);
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 3, 3 * valve.n), faces, is_flat ? std::vector<double>{0, h} : faces}, {},
                        valve.n_dimensions),
               TimeScheme::adams_bashforth);
  setup.pressure.relative_tolerance = 1e-10;
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(1.0)})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  for (std::size_t d = 1; d < static_cast<std::size_t>(valve.n_dimensions); ++d)
    setup.border[d][0] = setup.border[d][1] = {whole_border(SlipWall{})};
  const auto sheets = std::make_shared<EdgedSheets>(h, is_flat ? h : -1);
  const StretchedGrid grid = setup.grid;
  setup.bodies = [=](double) {
    // From beyond the ceiling, and beyond the sides in three dimensions, down to the gap.
    constexpr double above = 1.3;
    const double x0 = 1.5 + valve.offset * h, length = (above - floor) / std::cos(angle);
    const auto x = [&](double s) { return x0 + (s - (above - 1) / std::cos(angle)) * std::sin(angle); };
    const auto y = [&](double s) { return above - s * std::cos(angle); };
    std::vector<BodySurface> surfaces;
    std::vector<SurfaceTree> trees;
    std::vector<EdgeObstacle> obstacles;
    if (valve.block > 0) {
      const double from = x(length) - 0.4, to = x(length) + 0.3, low = -0.2, high = valve.block;
      PlanePath outline;
      for (const auto& corner : {std::array{from, low}, {to, low}, {to, high}, {from, high}}) {
        outline.place.push_back(corner);
        outline.velocity.push_back({0, 0});
      }
      surfaces.push_back(prism_over(outline, h, true));
      const std::array<SurfaceInTree, 1> in_tree{
          SurfaceInTree{&surfaces[0], {}, static_cast<int>(surfaces[0].triangle.size())}};
      trees.emplace_back(in_tree);
      obstacles.push_back({&surfaces[0], &trees[0]});
    }
    BodySurface sheet;
    if (is_flat) {
      PlanePath path;
      for (int i = 0; i <= 4 * valve.n; ++i) {
        path.place.push_back({x(length * i / (4 * valve.n)), y(length * i / (4 * valve.n))});
        path.velocity.push_back({0, 0});
      }
      sheet = prism_over(path, h, false);
    } else {
      sheet = flat_sheet({x(0), y(0), -0.5}, {x(length) - x(0), y(length) - y(0), 0}, {0, 0, 2}, 4 * valve.n);
    }
    surfaces.push_back(sheets->prolonged(0, sheet, {}, [&](const Point& from, const Point& direction) {
      return edge_clearance(grid, obstacles, from, direction, h);
    }));
    return surfaces;
  };
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state;
  pressure_forces(flow, 1e-4, 1, &state);
  double rate = 0;
  const Box& mine = flow.decomposition().mine();
  if (mine.begin[0] == 0)
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j) rate += state.velocity[0](0, j, k) * h * (is_flat ? 1 : h);
  return summed(rate) / state.time;
}

TEST(GapBesideAnEdge, OfAHalfToFourCellsLetsPassWhatAFineGridSays) {
  // Limits: 80 to 320 cells to a length, where gaps are 4 to 32 cells.
  for (const auto& [gap, limit] : {std::pair{0.2, 0.2178}, {0.1, 0.1810}, {0.05, 0.1543}, {0.025, 0.1345}}) {
    double worst = 0;
    for (const double offset : {0.0, 0.17, 0.5, 0.83})
      worst = std::max(worst, std::abs(conductance({.gap = gap, .offset = offset}) / limit - 1));
    RecordProperty("error_gap_" + std::to_string(gap), std::to_string(worst));
    EXPECT_LT(worst, gap < 0.04 ? 0.04 : 0.02) << gap;  // 2 % asked for of gaps of a cell and more
  }
}

TEST(GapBesideAnEdge, ShutsSmoothlyAndIsTightAtContact) {
  // The last tenth of a cell shuts the edge: conductances fall with the gap, in proportion at the end.
  double wider = conductance({.gap = 0.01});
  for (const double gap : {0.005, 0.0025, 0.00125, 0.0003}) {
    const double narrow = conductance({.gap = gap});
    EXPECT_LT(narrow, wider) << gap;
    EXPECT_GT(narrow, 0.2 * wider) << gap;
    wider = narrow;
  }
  for (const double offset : {0.0, 0.17, 0.5, 0.83})
    EXPECT_LT(std::abs(conductance({.gap = 0, .offset = offset})), 1e-9) << offset;  // of 0.15: the solver's tolerance
}

TEST(GapBesideAnEdge, IsTightWhereItTouchesABody) {
  for (const double offset : {0.0, 0.29, 0.5})
    for (const double block : {0.23, 0.25, 0.262})
      EXPECT_LT(std::abs(conductance({.gap = 0, .offset = offset, .block = block})), 1e-9) << offset << " " << block;
}

TEST(GapBesideAnEdge, InThreeDimensionsPassesTheSameAndIsTightAtContact) {
  // The same valve, drawn out across the channel, with 16 cells to a length.
  EXPECT_NEAR(conductance({.n = 16, .gap = 0.1, .n_dimensions = 3}), 0.1810, 0.02 * 0.1810);
  EXPECT_NEAR(conductance({.n = 16, .gap = 0.05, .n_dimensions = 3}), 0.1543, 0.02 * 0.1543);
  EXPECT_LT(std::abs(conductance({.n = 16, .gap = 0, .n_dimensions = 3})), 1e-9);
}

}  // namespace
}  // namespace couplet::flow
