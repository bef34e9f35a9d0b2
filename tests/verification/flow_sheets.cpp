// Thin sheets in the flow: tightness, smoothness of the force, free edges, gaps.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>

#include "flow-server/immersed/thick_sheet.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"
#include "tests/verification/moving_bodies.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;
constexpr double degree = pi / 180;

/// A flat sheet right across a channel of 3 x 1 that moves along it by 20 cells to and fro, slides along itself and may
/// turn.
struct Spanning {
  double angle = 0, slide = 0, turn = 0;  // [rad], [m/s], [rad]
  int n = 20;
};

NavierStokesSetup spanning_sheet(const Spanning& sheet) {
  const double h = 1.0 / sheet.n, amplitude = 0.5;
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 3, 3 * sheet.n), uniform_faces(0, 1, sheet.n), {0, h}}, {}, 2),
               TimeScheme::adams_bashforth);
  setup.viscosity = 0.01;
  const auto speed = [=](double t) { return 2 * amplitude * std::sin(2 * t); };
  setup.bodies = [=](double t) {
    const double angle = sheet.angle + sheet.turn * std::sin(2 * t), rate = 2 * sheet.turn * std::cos(2 * t);
    const double x0 = 1 + amplitude * (1 - std::cos(2 * t)), length = 3;
    PlanePath path;
    for (int i = 0; i <= 80; ++i) {
      const double s = length * (i / 80.0 - 0.5), dx = -std::sin(angle) * s, dy = std::cos(angle) * s;
      path.place.push_back({x0 + dx, 0.5 + dy});
      path.velocity.push_back(
          {speed(t) - rate * dy - sheet.slide * std::sin(angle), rate * dx + sheet.slide * std::cos(angle)});
    }
    return std::vector<BodySurface>{prism_over(path, h, false)};
  };
  setup.border[0][0] = {whole_border(PrescribedVelocity{
      {SpaceTimeValue([=](const Point&, double t) { return speed(t); }), SpaceTimeValue(0.0), SpaceTimeValue(0.0)}})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  setup.border[1][0] = setup.border[1][1] = {whole_border(SlipWall{})};
  return setup;
}

double roughness_of(const Spanning& sheet) {
  const NavierStokesSetup setup = spanning_sheet(sheet);
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  return roughness(pressure_forces(flow, 0.005, 628), 10);
}

TEST(SpanningSheet, PushesTheFluidAsAPlugWhereNothingSlides) {
  for (const double angle : {0.0, 27 * degree}) {
    const NavierStokesSetup setup = spanning_sheet({angle, 0, 0});
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    FlowState state;
    pressure_forces(flow, 0.005, 300, &state);
    const double speed = std::sin(2 * state.time);
    double largest = 0;
    const Triple sizes = flow.decomposition().mine().sizes();
    for (int j = 0; j < sizes[1]; ++j)
      for (int i = 0; i < sizes[0]; ++i) largest = std::max(largest, std::abs(state.velocity[0](i, j, 0) - speed));
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    // Exact in space. In time the slip that the change of the pressure gradient leaves: dt^2 dU'/dt / rho = 1e-4, times
    // 1 - (sum of the images' ratios), at most 2.9 where a ghost lies a cell and a half behind the wall.
    EXPECT_LT(largest, 3e-4) << angle;
  }
}

// Roughness of the force: what a two-dimensional prototype of the method had, 0.04 % and 0.017 % (a staircase of closed
// faces: 16 and 6 %), with room for other places of the sheet among the cells.
TEST(SpanningSheet, ForceIsSmoothWhereItSlides) {
  const double rough = roughness_of({27 * degree, 0.5, 0});
  RecordProperty("roughness", std::to_string(rough));
  EXPECT_LT(rough, 0.0005);
}

TEST(SpanningSheet, ForceIsSmoothWhereItTurns) {
  const double rough = roughness_of({20 * degree, 0, 23 * degree});
  RecordProperty("roughness", std::to_string(rough));
  EXPECT_LT(rough, 0.0003);
}

TEST(SpanningSheet, IsTight) {
  constexpr int n = 40;
  for (const double angle : {0.0, 27 * degree, 45 * degree}) {
    const double leak = leak_through(n, [&](double h) {
      PlanePath path;
      for (int i = 0; i <= 50; ++i) {
        const double s = 6 * n * h * (i / 50.0 - 0.5);
        path.place.push_back({1.5 * n * h - std::sin(angle) * s, 0.5 * n * h + std::cos(angle) * s});
        path.velocity.push_back({0, 0});
      }
      return prism_over(path, h, false);
    });
    EXPECT_LT(leak, 1e-10) << angle;  // the tolerance of the pressure in 20 steps
  }
}

/// A plate of length 1 in a box of 4 that is beaten to and fro by a quarter of its length and turns from 20 to 49
/// degrees.
/// With a thickness [cells] it is a closed body, 0: a sheet with smooth free edges.
NavierStokesSetup flapping_plate(int n, double thickness = 0) {
  const double h = 1.0 / n;
  const std::vector<double> faces = uniform_faces(0, 4, 4 * n);
  NavierStokesSetup setup = setup_on(box_grid({faces, faces, {0, h}}, {}, 2), TimeScheme::adams_bashforth);
  setup.viscosity = 0.01;
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  const auto sheets = std::make_shared<EdgedSheets>(h, h);
  setup.bodies = [=](double t) {
    const double middle = 34.5 * degree, swing = 14.5 * degree;
    const double angle = middle - swing * std::cos(4 * t), rate = 4 * swing * std::sin(4 * t);
    const double heave = -0.25 * std::cos(4 * t), speed = std::sin(4 * t);
    const std::array<double, 2> normal{-std::sin(middle), std::cos(middle)};
    PlanePath path;
    for (int i = 0; i <= 4 * n; ++i) {
      const double s = i / (4.0 * n) - 0.5, x = s * std::cos(angle), y = s * std::sin(angle);
      path.place.push_back({2.013 + heave * normal[0] + x, 2.007 + heave * normal[1] + y});
      path.velocity.push_back({speed * normal[0] - rate * y, speed * normal[1] + rate * x});
    }
    BodySurface plate = prism_over(path, h, false);
    if (thickness == 0) return std::vector<BodySurface>{sheets->prolonged(0, plate)};
    const std::vector<BorderPlane> planes{{2, 0.0}, {2, h}};
    const SurfaceTopology topology = orient_surface(plate, FluidSide::outside, planes);
    return std::vector<BodySurface>{ThickSheet(plate, topology, thickness * h).surface()};
  };
  return setup;
}

/// The force of the pressure over 1.575 s, a quarter more than half a period.
std::vector<double> forces_on_flapping_plate(int n, double step, double thickness = 0) {
  const NavierStokesSetup setup = flapping_plate(n, thickness);
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  return pressure_forces(flow, step, static_cast<int>(std::lround(1.575 / step)));
}

TEST(FreePlate, ForceIsSmoothAndTheSameWithShorterSteps) {
  const std::vector<double> force = forces_on_flapping_plate(20, 0.0025), finer = forces_on_flapping_plate(20, 0.00125);
  RecordProperty("courant_0.05", std::to_string(roughness(force, 10)));
  RecordProperty("courant_0.025", std::to_string(roughness(finer, 10)));
  EXPECT_LT(roughness(force, 10), 0.003);   // asked for; an edge that opens cells at once has 1.6 %
  EXPECT_LT(roughness(finer, 10), 0.0015);  // likewise
  // The openings beside the edges take part in the pressure's balance anew in every step. Where they only answered its
  // increments a difference of pressures that no slope knows grew over the steps, faster with shorter ones: waves of 14
  // and 50 % of the force with these two steps and velocities of 20 m/s, and with half of the last one no result.
  const std::vector<double> finest = forces_on_flapping_plate(20, 0.000625);
  const auto mean_over = [](const std::vector<double>& values, std::size_t end, std::size_t n) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(end - n),
                           values.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
           static_cast<double>(n);
  };
  double square = 0, difference = 0;
  for (std::size_t i = 40; i <= force.size(); i += 2) {
    const double coarse = mean_over(force, i, 4), fine = mean_over(finest, 4 * i, 16);  // over 0.01 s
    square += coarse * coarse, difference += (coarse - fine) * (coarse - fine);
  }
  RecordProperty("difference_by_step", std::to_string(std::sqrt(difference / square)));
  EXPECT_LT(std::sqrt(difference / square), 0.08);  // measured 6 %
}

TEST(FreePlate, WithoutThicknessIsNearerToAFineGridThanWithAnyThatAGridCanSee) {
  // The same plate as a closed body of some cells' thickness, for comparison, beside one without thickness on a grid
  // that is twice as fine. Means over 0.01 s; the first tenth of a second is left out.
  const auto smoothed = [](const std::vector<double>& force, std::size_t n, double depth) {
    std::vector<double> means;
    for (std::size_t i = 10 * n; i + n <= force.size(); i += n)
      means.push_back(std::accumulate(force.begin() + static_cast<std::ptrdiff_t>(i),
                                      force.begin() + static_cast<std::ptrdiff_t>(i + n), 0.0) /
                      (static_cast<double>(n) * depth));
    return means;
  };
  const std::vector<double> fine = smoothed(forces_on_flapping_plate(40, 0.0025), 4, 1.0 / 40);
  double without = 0;
  for (const double thickness : {0.0, 1.0, 2.0, 3.0}) {
    const std::vector<double> force = forces_on_flapping_plate(20, 0.0025, thickness);
    const std::vector<double> means = smoothed(force, 4, 1.0 / 20);
    double square = 0, difference = 0, sum = 0;
    for (std::size_t i = 0; i < std::min(means.size(), fine.size()); ++i) {
      square += fine[i] * fine[i], difference += (means[i] - fine[i]) * (means[i] - fine[i]);
      sum += means[i] * fine[i];
    }
    const double error = std::sqrt(difference / square), rough = roughness(force, 10);
    const std::string name = "thickness_" + std::to_string(static_cast<int>(thickness));
    RecordProperty(name + "_error", std::to_string(error));
    RecordProperty(name + "_amplitude", std::to_string(sum / square));
    RecordProperty(name + "_roughness", std::to_string(rough));
    if (thickness == 0)
      without = error;
    else
      EXPECT_LT(without, error) << thickness;
  }
}

/// Flow rate that a pressure of 1 Pa drives through the gap between the edge of an inclined sheet and the wall, per
/// time, without viscosity: dQ/dt per pressure.
double conductance(int n, double gap, double offset) {
  const double h = 1.0 / n, angle = 27 * degree;
  NavierStokesSetup setup = setup_on(box_grid({uniform_faces(0, 3, 3 * n), uniform_faces(0, 1, n), {0, h}}, {}, 2),
                                     TimeScheme::adams_bashforth);
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(1.0)})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  setup.border[1][0] = setup.border[1][1] = {whole_border(SlipWall{})};
  const auto sheets = std::make_shared<EdgedSheets>(h, h);
  setup.bodies = [=](double) {
    PlanePath path;
    for (int i = 0; i <= 4 * n; ++i) {
      const double s = (1 - gap) / std::cos(angle) * i / (4 * n);
      path.place.push_back({1.5 + offset * h + s * std::sin(angle), 1 - s * std::cos(angle)});
      path.velocity.push_back({0, 0});
    }
    return std::vector<BodySurface>{
        sheets->prolonged(0, prism_over(path, h, false), [](const Point& p) { return p[1] > 0.999; })};
  };
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state;
  pressure_forces(flow, 1e-4, 1, &state);
  double rate = 0;
  if (flow.decomposition().mine().begin[0] == 0)
    for (int j = 0; j < flow.decomposition().mine().size(1); ++j) rate += state.velocity[0](0, j, 0) * h;
  return summed(rate) / state.time;
}

/// Largest speed after 150 steps of no length over that after the first: a plate of 6 x 4 cells at rest in whirls.
double growth_beside_plate(const Eigen::Quaterniond& turn) {
  const int n = 16;
  const std::vector<double> faces = uniform_faces(0, n, n);
  NavierStokesSetup setup = setup_on(box_grid({faces, faces, faces}, {}), TimeScheme::adams_bashforth);
  setup.pressure.relative_tolerance = 1e-6;
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  for (int d = 0; d < 3; ++d)
    setup.initial_velocity[static_cast<std::size_t>(d)] = SpaceTimeValue([d](const Point& at, double) {
      return std::sin(0.9 * at[0] - 0.4 * at[1] + 0.7 * at[2] + d) + std::cos(1.8 * at[1] - 0.8 * at[2] + 2 * d) +
             std::sin(2.1 * at[2] + 1.2 * at[0] + d * d);
    });
  const Eigen::Vector3d first = turn * Eigen::Vector3d(6, 0, 0), second = turn * Eigen::Vector3d(0, 4, 0);
  const Eigen::Vector3d corner = Eigen::Vector3d(8.3, 7.9, 7.6) - 0.5 * (first + second);
  const auto point = [](const Eigen::Vector3d& at) { return Point{at[0], at[1], at[2]}; };
  EdgedSheets sheets(1, n);
  const BodySurface plate = sheets.prolonged(0, flat_sheet(point(corner), point(first), point(second), 8));
  setup.bodies = [plate](double) { return std::vector<BodySurface>{plate}; };
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  double speed = 0;
  for (int step = 0; step < 150; ++step) {
    const AdvanceReport report = flow.advance(state, 1e-9, next);
    std::swap(state, next);
    if (step == 0) speed = report.largest_speed;
  }
  return state.largest_speed / speed;
}

TEST(FreePlate, StepsOfNoLengthDoNotSpeedTheFluidUp) {
  // A tenth for speeds that walls slow down on one side and not yet on the other. Where the flow between the two sides
  // of the open strip around the plate was left to the pressure it was 6 to 390 times the first.
  for (const Eigen::Vector4d& turn : {Eigen::Vector4d(0.1, 0.9, -0.4, 0.3), Eigen::Vector4d(-0.6, 0.2, 0.5, 0.7),
                                      Eigen::Vector4d(0.8, -0.3, 0.1, -0.5)})
    EXPECT_LT(growth_beside_plate(Eigen::Quaterniond(turn).normalized()), 1.1) << turn.transpose();
}

TEST(FreePlate, LetsPassBesideItsEdgeWhatAFineGridSays) {
  // 0.2178 is the limit of ever finer grids, four ways of treating the edge alike (prototype in two dimensions).
  for (const double offset : {0.0, 0.17, 0.5, 0.83}) EXPECT_NEAR(conductance(20, 0.2, offset), 0.2178, 0.01 * 0.2178);
}

TEST(SpanningSheet, InASquareDuctForceIsSmooth) {
  const int n = 12;
  const double amplitude = 0.5;
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 3, 3 * n), uniform_faces(0, 1, n), uniform_faces(0, 1, n)}, {}),
               TimeScheme::adams_bashforth);
  setup.viscosity = 0.01;
  const auto speed = [=](double t) { return 2 * amplitude * std::sin(2 * t); };
  const double angle = 27 * degree, tilt = 15 * degree;
  setup.bodies = [=](double t) {
    const double x0 = 1 + amplitude * (1 - std::cos(2 * t));
    const std::array<double, 3> a{-std::sin(angle), std::cos(angle), 0},
        b{-std::sin(tilt) * std::cos(angle), -std::sin(tilt) * std::sin(angle), std::cos(tilt)};
    Point corner, first, second, velocity;
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = 3 * a[d], second[d] = 3 * b[d];
      corner[d] = (d == 0 ? x0 : 0.5) - 1.5 * (a[d] + b[d]);
      velocity[d] = (d == 0 ? speed(t) : 0) + 0.5 * a[d] + 0.3 * b[d];
    }
    BodySurface sheet = flat_sheet(corner, first, second, 20);
    std::fill(sheet.velocity.begin(), sheet.velocity.end(), velocity);
    return std::vector<BodySurface>{sheet};
  };
  setup.border[0][0] = {whole_border(PrescribedVelocity{
      {SpaceTimeValue([=](const Point&, double t) { return speed(t); }), SpaceTimeValue(0.0), SpaceTimeValue(0.0)}})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  for (std::size_t d = 1; d < 3; ++d) setup.border[d][0] = setup.border[d][1] = {whole_border(SlipWall{})};
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  const double rough = roughness(pressure_forces(flow, 0.01, 120), 5);
  RecordProperty("roughness", std::to_string(rough));
  EXPECT_LT(rough, 0.001);  // asked for
}

}  // namespace
}  // namespace couplet::flow
