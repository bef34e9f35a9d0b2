// The force on a body is the same on any number of ranks.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

FacePatch whole_border(FaceCondition condition) {
  FacePatch patch;
  patch.name = "border";
  patch.condition = std::move(condition);
  return patch;
}

TEST(FlowBodyLoadsInvariance, LoadsAreTheSameOnAnyNumberOfRanks) {
  const int n = 12;
  NavierStokesSetup setup = setup_on(
      box_grid({uniform_faces(0, 2, 2 * n), uniform_faces(0, 1, n), uniform_faces(0, 1, n)}, {false, false, true}),
      TimeScheme::adams_bashforth);
  setup.viscosity = 0.02;
  setup.pressure.relative_tolerance = 1e-10;
  setup.pressure.divergence_tolerance = 1e-14;
  setup.border[0][0] = {
      whole_border(PrescribedVelocity{{SpaceTimeValue(1.0), SpaceTimeValue(0.0), SpaceTimeValue(0.0)}})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  setup.bodies = [](double time) {
    BodySurface ball = sphere_surface({0.98 - 0.1 * std::cos(time), 0.52, 0.53}, 0.25, 4);
    for (Point& velocity : ball.velocity) velocity = {0.1 * std::sin(time), 0, 0};
    return std::vector<BodySurface>{ball};
  };
  const auto loads_on = [&](const BlockDecomposition& blocks) {
    FractionalStep flow(setup, blocks);
    FlowState state = flow.initial_state(), next;
    for (int step = 0; step < 5; ++step) {
      flow.advance(state, 0.01, next);
      std::swap(state, next);
    }
    return flow.body_loads(state)[0];
  };
  const SurfaceLoad serial = loads_on(decompose(setup.grid, {1, 1, 1}, MPI_COMM_SELF)),
                    parallel = loads_on(decompose(setup.grid));
  double largest = 0;
  for (const Point& force : serial.corner_force) largest = std::max(largest, std::abs(force[0]));
  ASSERT_GT(largest, 0);
  // Pressures are solved to 1e-10.
  for (std::size_t c = 0; c < serial.corner_force.size(); ++c)
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_NEAR(parallel.corner_force[c][d], serial.corner_force[c][d], 1e-7 * largest);
  EXPECT_NEAR(parallel.viscous_force[0], serial.viscous_force[0], 1e-8 * std::abs(serial.viscous_force[0]));
}

}  // namespace
}  // namespace couplet::flow
