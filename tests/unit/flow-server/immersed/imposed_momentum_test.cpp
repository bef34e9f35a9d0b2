#include "flow-server/immersed/imposed_momentum.hpp"

#include <gtest/gtest.h>

#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

/// A sphere in a flow that took a step, and the force on it of what its wall has imposed.
struct Imposed {
  explicit Imposed(const std::function<Point(const Point&)>& wall_velocity)
      : sphere(sphere_surface({0.51, 0.48, 0.5}, 0.3, 4)) {
    for (std::size_t c = 0; c < sphere.position.size(); ++c) sphere.velocity[c] = wall_velocity(sphere.position[c]);
    placed = std::make_unique<PlacedBodies>(uniform_box({16, 16, 16}, 1.0 / 16), std::vector<BodySurface>{sphere});
  }

  SurfaceLoad with(double step, double density) {
    FlowState state;
    state.velocity = std::move(placed->velocity);
    state.pressure = std::move(placed->pressure);
    state.bodies = std::move(placed->bodies);
    state.last_step = step;
    std::vector<SurfaceLoad> loads = BodyLoads::no_loads(state.bodies->surfaces());
    add_imposed_momentum(placed->block, density, state, loads);
    return loads.front();
  }

  BodySurface sphere;
  std::unique_ptr<PlacedBodies> placed;
};

double largest_of(const SurfaceLoad& load) {
  double largest = 0;
  for (const Point& force : load.corner_force) largest = std::max(largest, length(force));
  return largest;
}

TEST(ImposedMomentum, IsNoneWhereTheFlowIsWhatTheWallAsksFor) {
  const auto flow = [](const Point& x) { return Point{0.3 * x[0] - 2 * x[1], x[2] + 1, 0.4 * x[0] - 0.3 * x[2]}; };
  Imposed imposed(flow);
  imposed.placed->set_velocity([&](const Point& x, int d) { return flow(x)[static_cast<std::size_t>(d)]; });
  imposed.placed->set_pressure([](const Point& x) { return 5 - 3 * x[0] + 2 * x[1] + x[2]; });
  // Round-off, but for faces on the wall but for a thousandth of a cell: their image lies along the wall's normal,
  // which is not quite their own. Slips of 1e-3 h |grad u| = 1.3e-4 in volumes of h^3 = 2.4e-4 make 0.03.
  EXPECT_LT(largest_of(imposed.with(1e-3, 1000)), 0.03);
}

TEST(ImposedMomentum, OfAStreamPastAWallAtRestActsAlongTheStream) {
  const auto force_with = [](double step, double density) {
    Imposed imposed([](const Point&) { return Point{}; });
    imposed.placed->set_velocity([](const Point&, int d) { return d == 0 ? 1.0 : 0.0; });
    return imposed.with(step, density);
  };
  const SurfaceLoad load = force_with(1e-3, 1);
  EXPECT_GT(load.pressure_force[0], 0);
  // The shell of hybrid velocities, a quarter of a cell thick, would be stopped in each step by half on average; more
  // on its outside, where the stream at the images is what the wall takes.
  const double shell = 4 * 3.1416 * 0.09 * 0.25 / 16;
  EXPECT_LT(load.pressure_force[0], 0.5 * shell / 1e-3);
  EXPECT_LT(length(Point{0, load.pressure_force[1], load.pressure_force[2]}), 0.1 * load.pressure_force[0]);
  Point sum{};
  for (const Point& force : load.corner_force) sum = sum + force;
  EXPECT_NEAR(length(sum - load.pressure_force), 0,
              1e-12 * load.pressure_force[0]);  // round-off of some thousand terms
  EXPECT_NEAR(force_with(0.5e-3, 1).pressure_force[0], 2 * load.pressure_force[0], 1e-9 * load.pressure_force[0]);
  EXPECT_NEAR(force_with(1e-3, 3).pressure_force[0], 3 * load.pressure_force[0], 1e-9 * load.pressure_force[0]);
}

TEST(ImposedMomentum, IsNoneBeforeTheFirstStep) {
  Imposed imposed([](const Point&) { return Point{}; });
  imposed.placed->set_velocity([](const Point&, int d) { return d == 0 ? 1.0 : 0.0; });
  EXPECT_EQ(largest_of(imposed.with(std::numeric_limits<double>::quiet_NaN(), 1)), 0);
}

}  // namespace
}  // namespace couplet::flow
