// Walls that come together: a sheet that folds onto itself, closed bodies that touch and part.

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"
#include "tests/verification/moving_bodies.hpp"

namespace couplet::flow {
namespace {

constexpr double pi = std::numbers::pi;

/// Gap [m] of walls that close from 4 cells to a smallest one and part again within 2 s, and its rate [m/s].
struct ClosingGap {
  double cell_width, smallest;  // [m], [cells]
  double swing() const { return 0.5 * (4 - smallest) * cell_width; }
  double at(double t) const { return smallest * cell_width + swing() * (1 + std::cos(pi * t)); }
  double rate(double t) const { return -pi * swing() * std::sin(pi * t); }
};

/// Of the time after the first tenth of a second: bodies start at once.
struct Extremes {
  double speed = 0, force = 0;  // [m/s], [N], in two dimensions [N/m]
  double usual_force = 0;       // nine of ten steps have no more
  bool is_finite = true;
};

Extremes extremes_of(const NavierStokesSetup& setup, double step, double until) {
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  const double depth = setup.grid.n_dimensions == 2 ? setup.grid.axis[2].end() - setup.grid.axis[2].start() : 1;
  Extremes extremes;
  std::vector<double> forces;
  for (int n = 0; n < static_cast<int>(std::lround(until / step)); ++n) {
    const AdvanceReport report = flow.advance(state, step, next);
    std::swap(state, next);
    extremes.is_finite = extremes.is_finite && std::isfinite(report.largest_speed);
    if (state.time < 0.1) continue;
    extremes.speed = std::max(extremes.speed, report.largest_speed);
    forces.push_back(0);
    for (const SurfaceLoad& load : flow.body_loads(state))
      for (std::size_t d = 0; d < 3; ++d) {
        const double force = load.pressure_force[d] + load.viscous_force[d];
        extremes.is_finite = extremes.is_finite && std::isfinite(force);
        forces.back() = std::max(forces.back(), std::abs(force) / depth);
      }
  }
  std::sort(forces.begin(), forces.end());
  extremes.force = forces.back();
  extremes.usual_force = forces[forces.size() * 9 / 10];
  return extremes;
}

NavierStokesSetup open_box(double side, int n, int n_dimensions) {
  const std::vector<double> faces = uniform_faces(0, side, static_cast<int>(std::lround(side * n)));
  const bool is_flat = n_dimensions == 2;
  NavierStokesSetup setup =
      setup_on(box_grid({faces, faces, is_flat ? std::vector<double>{0, 1.0 / n} : faces}, {}, n_dimensions),
               TimeScheme::adams_bashforth);
  setup.viscosity = 0.01;
  setup.pressure = {};  // as a user would run it
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  return setup;
}

/// One sheet of two halves of `length`, hinged at its middle, whose ends come together. It drifts through the grid.
NavierStokesSetup folding_sheet(int n, double smallest_gap) {
  constexpr double length = 0.5;
  const double h = 1.0 / n;
  NavierStokesSetup setup = open_box(2, n, 2);
  const ClosingGap gap{h, smallest_gap};
  const auto sheets = std::make_shared<EdgedSheets>(h, h);
  setup.bodies = [=](double t) {
    const double sine = gap.at(t) / (2 * length), cosine = std::sqrt(1 - sine * sine);
    const double sine_rate = gap.rate(t) / (2 * length), cosine_rate = -sine * sine_rate / cosine;
    PlanePath path;
    for (int i = -2 * n; i <= 2 * n; ++i) {
      const double s = length * std::abs(i) / (2.0 * n), side = i < 0 ? -1 : 1;
      path.place.push_back({0.713 + 0.1 * t + s * cosine, 1.007 + 0.07 * t + side * s * sine});
      path.velocity.push_back({0.1 + s * cosine_rate, 0.07 + side * s * sine_rate});
    }
    return std::vector<BodySurface>{sheets->prolonged(0, prism_over(path, h, false))};
  };
  return setup;
}

/// Two round bodies of radius 0.25, cylinders or spheres, along an oblique line through both. They drift.
NavierStokesSetup touching_bodies(int n, double smallest_gap, int n_dimensions) {
  constexpr double radius = 0.25;
  const double h = 1.0 / n;
  NavierStokesSetup setup = open_box(n_dimensions == 2 ? 2 : 1.5, n, n_dimensions);
  const ClosingGap gap{h, smallest_gap};
  const Point middle = n_dimensions == 2 ? Point{0.95, 0.98, 0} : Point{0.7, 0.73, 0.741};
  const Point along = n_dimensions == 2 ? Point{0.8, 0.6, 0} : Point{2.0 / 3, 2.0 / 3, 1.0 / 3};
  const BodySurface ball = n_dimensions == 2 ? BodySurface{} : sphere_surface({0, 0, 0}, radius, 4);
  setup.bodies = [=](double t) {
    std::vector<BodySurface> bodies;
    for (const double side : {-1.0, 1.0}) {
      Point centre, speed;
      for (std::size_t d = 0; d < 3; ++d) {
        const double drift = d == 0 ? 0.1 : d == 1 ? 0.07 : 0;
        centre[d] = middle[d] + drift * t + side * (radius + 0.5 * gap.at(t)) * along[d];
        speed[d] = drift + side * 0.5 * gap.rate(t) * along[d];
      }
      if (n_dimensions == 2) {
        bodies.push_back(circle({centre[0], centre[1]}, radius, 32 * n, h, [&](double, double) {
          return std::array<double, 2>{speed[0], speed[1]};
        }));
        continue;
      }
      bodies.push_back(ball);
      for (Point& at : bodies.back().position)
        for (std::size_t d = 0; d < 3; ++d) at[d] += centre[d];
      std::fill(bodies.back().velocity.begin(), bodies.back().velocity.end(), speed);
    }
    return bodies;
  };
  return setup;
}

TEST(FoldingSheet, RunsThroughAnyGapWithBoundedSpeedsAndForces) {
  constexpr int n = 20;
  constexpr double half = 0.5, step = 0.005;
  for (const double cells : {2.0, 1.0, 0.5, 0.0}) {
    const ClosingGap gap{1.0 / n, cells};
    const Extremes met = extremes_of(folding_sheet(n, cells), step, 2);
    const std::string name = "gap_" + std::to_string(cells).substr(0, 3);
    RecordProperty(name + "_speed", std::to_string(met.speed));
    RecordProperty(name + "_force", std::to_string(met.force));
    RecordProperty(name + "_usual_force", std::to_string(met.usual_force));
    EXPECT_TRUE(met.is_finite) << cells;
    // Between the halves u = (dg/dt) x^2 / (2 L g(x)), g(x) = g x / L: at the ends L (dg/dt) / (2 g), which is largest
    // where the gap is twice the smallest one, L pi / 2 sqrt(swing / (2 smallest)). Gaps below half a cell count as so
    // wide, since the slit of one sheet is no longer there then. 1.5 for the profile, and the speed of the ends.
    const double narrowest = std::max(cells, 0.5) * gap.cell_width;
    const double pressed = half * pi / 2 * std::sqrt(gap.swing() / (2 * narrowest));
    EXPECT_LT(met.speed, 1.5 * pressed + pi * gap.swing() / 2 + 0.13) << cells;
    // No more than what stops and turns all fluid within a length of the sheet in one step: slits come and go in one.
    EXPECT_LT(met.force, 2 * met.speed * 4 * half * half / step) << cells;
  }
}

/// Through a sheet that runs up, down and up again, as a Z with its three strokes so many cells apart.
double leak_of_fold(double cells) {
  constexpr int n = 20;
  return leak_through(n, [&](double h) {
    const double x = 1.5 * n * h, gap = cells * h, H = n * h, tilt = 0.1;
    PlanePath path;
    const std::array<std::array<double, 2>, 4> corner{
        {{x - gap, -0.3 * H}, {x - gap, 0.713 * H}, {x, 0.287 * H}, {x, 1.3 * H}}};
    for (std::size_t c = 0; c + 1 < corner.size(); ++c)
      for (int i = 0; i < 40; ++i) {
        const double s = i / 40.0;
        const double px = corner[c][0] + s * (corner[c + 1][0] - corner[c][0]);
        const double py = corner[c][1] + s * (corner[c + 1][1] - corner[c][1]);
        path.place.push_back({px + tilt * py, py});
        path.velocity.push_back({0, 0});
      }
    path.place.push_back({corner[3][0] + tilt * corner[3][1], corner[3][1]});
    path.velocity.push_back({0, 0});
    return prism_over(path, h, false);
  });
}

TEST(FoldedSheet, IsTightWhateverTheGapBetweenItsFolds) {
  for (const double cells : {2.0, 1.0, 0.5, 0.01}) {
    const double leak = leak_of_fold(cells);
    RecordProperty("leak_in_1e-12_gap_" + std::to_string(cells).substr(0, 4), std::to_string(1e12 * leak));
    EXPECT_LT(leak, 1e-10) << cells;  // as of a flat sheet: the tolerance of the pressure in 20 steps
  }
}

class TouchingBodies : public testing::TestWithParam<int> {};  // dimensions

TEST_P(TouchingBodies, PartAgainWithBoundedSpeedsAndForces) {
  const int n_dimensions = GetParam(), n = n_dimensions == 2 ? 20 : 12;
  constexpr double radius = 0.25;
  for (const double cells : {2.0, 1.0, 0.0}) {
    const ClosingGap gap{1.0 / n, cells};
    const Extremes met = extremes_of(touching_bodies(n, cells, n_dimensions), n_dimensions == 2 ? 0.01 : 0.02, 2);
    const std::string name = "gap_" + std::to_string(static_cast<int>(cells));
    RecordProperty(name + "_speed", std::to_string(met.speed));
    RecordProperty(name + "_force", std::to_string(met.force));
    EXPECT_TRUE(met.is_finite) << cells;
    // Pressed out between parabolas, u = (dg/dt) x / (m (g + x^2 / R)), m = 1, of spheres 2: at most
    // (dg/dt) sqrt(R / g) / (2 m) and, since (dg/dt)^2 < 2 pi^2 swing g, pi sqrt(2 R swing) / (2 m), whatever the
    // smallest gap. 1.5 for the profile; the bodies' own speed.
    const double m = n_dimensions - 1;
    EXPECT_LT(met.speed, 1.5 * pi * std::sqrt(2 * radius * gap.swing()) / (2 * m) + pi * gap.swing() / 2 + 0.13)
        << cells;
    // The acceleration a of the gap presses with rho a R / (2 m) ln((g + R) / (g + x^2 / R)), even at contact no more
    // than 2 rho a R^2 (of spheres pi / 4 rho a R^3); a body that moves alone by half of a has pi R^2 (2 / 3 pi R^3) of
    // fluid to move. Three times that for friction and the squares of the speeds.
    const double a = pi * pi * gap.swing(), R = radius;
    const double force = n_dimensions == 2 ? (2 + pi / 2) * a * R * R : (pi / 4 + pi / 3) * a * R * R * R;
    EXPECT_LT(met.force, 3 * force) << cells;
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, TouchingBodies, testing::Values(2, 3));

}  // namespace
}  // namespace couplet::flow
