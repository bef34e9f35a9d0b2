#include "flow-server/immersed/body_surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

const StretchedGrid box = uniform_box({20, 20, 20}, 0.05), flat_box = uniform_box({20, 20, 1}, 0.05, 2);

BodySetup body_of(const std::string& name, surface::SurfaceMesh mesh, bool is_closed) {
  BodySetup setup;
  setup.name = name;
  setup.mesh = std::move(mesh);
  setup.is_closed = is_closed;
  return setup;
}

BodySetup plate() {
  return body_of("plate", make_rectangle({0.3, 0.3, 0.5}, {0.4, 0, 0}, {0, 0.4, 0}, 0.1), false);
}

NodalMotion motion_at(double time, const BodySetup& setup, double displacement, double velocity) {
  const auto n = setup.mesh.n_nodes();
  NodalMotion motion{time, surface::NodeArray::Zero(n, 3), surface::NodeArray::Zero(n, 3)};
  motion.displacement.col(2).setConstant(displacement);
  motion.velocity.col(2).setConstant(velocity);
  return motion;
}

TEST(BodySurfaces, FollowPrescribedMotionWithTrianglesOfHalfACell) {
  BodySetup ball = body_of("ball", make_ellipsoid({0.5, 0.5, 0.5}, {0.2, 0.2, 0.2}, 0.2), true);
  FourierSeries swing;
  swing.frequency = 0.5, swing.sine = {0.1};
  ball.motion = PrescribedMotion({Translation{{TimeFunction(swing), TimeFunction(0.0), TimeFunction(0.0)}}});
  BodySurfaces bodies({ball, plate()}, box);
  const std::vector<BodySurface> start = bodies.at(0), later = bodies.at(0.5);
  ASSERT_EQ(start.size(), 2u);
  EXPECT_TRUE(start[0].is_closed);
  EXPECT_TRUE(start[0].opening.empty());
  EXPECT_FALSE(start[1].is_closed);
  for (const auto& corners : start[0].triangle)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(distance(start[0].position[static_cast<std::size_t>(corners[k])],
                         start[0].position[static_cast<std::size_t>(corners[(k + 1) % 3])]),
                0.5 * 0.05 + 1e-12);
  for (std::size_t c = 0; c < start[0].position.size(); ++c) {
    EXPECT_NEAR(later[0].position[c][0] - start[0].position[c][0], 0.1, 1e-14);
    EXPECT_NEAR(start[0].velocity[c][0], 0.1 * std::numbers::pi, 1e-14);
    EXPECT_NEAR(later[0].velocity[c][0], 0, 1e-14);
  }
}

TEST(BodySurfaces, BlendAWholeCellWhereTheyHaveSharpEdges) {
  const auto blend_of = [](const BodySetup& setup, const StretchedGrid& grid) {
    BodySurfaces bodies({setup}, grid);
    return bodies.at(0)[0].blend_width;
  };
  const DepthSpan depth{0, 1, true};
  BodySetup flag =
      body_of("flag", make_polygon_prism({{0.2, 0.45}, {0.8, 0.45}, {0.8, 0.55}, {0.2, 0.55}}, depth, 0.05), true);
  EXPECT_EQ(blend_of(flag, flat_box), 1);
  EXPECT_EQ(blend_of(body_of("box", make_box({0.3, 0.3, 0.3}, {0.6, 0.7, 0.7}, 0.05), true), box), 1);
  flag.blend_width = 0.5;
  EXPECT_EQ(blend_of(flag, flat_box), 0.5);
  // Round bodies, also where they end on borders, and corners that the fluid fills.
  EXPECT_FALSE(blend_of(body_of("ball", make_ellipsoid({0.5, 0.5, 0.5}, {0.2, 0.2, 0.2}, 0.05), true), box));
  EXPECT_FALSE(blend_of(body_of("rod", make_elliptic_cylinder({0.5, 0.5}, {0.2, 0.1}, depth, 0.02), true), flat_box));
  BodySetup tube = body_of("tube", make_tube({0.2, 0.5, 0.5}, {0.8, 0.5, 0.5}, 0.2, 0.05), true);
  tube.fluid = FluidSide::inside;
  EXPECT_FALSE(blend_of(tube, box));
}

TEST(BodySurfaces, AreProlongedBeyondFreeEdgesButNotBeyondBorders) {
  BodySurfaces bodies({plate()}, box);
  double beyond = 0;
  const std::vector<BodySurface> plates = bodies.at(0);
  for (const Point& p : plates[0].position) beyond = std::max(beyond, p[0] - 0.7);
  EXPECT_NEAR(beyond, EdgeRamp{}.beyond() * 0.05, 1e-12);
  // In two dimensions; the depth of the mesh is not that of the grid.
  BodySetup sheet = body_of("sheet", make_sheet_prism({{0.3, 0.2}, {0.3, 0.6}}, {0, 1, true}, 0.1), false);
  BodySurfaces flat({sheet}, flat_box);
  const BodySurface longer = flat.at(0)[0];
  double low = 1, high = 0;
  for (const Point& p : longer.position) {
    low = std::min(low, p[1]), high = std::max(high, p[1]);
    EXPECT_TRUE(p[2] >= 0 && p[2] <= 1);
  }
  EXPECT_NEAR(low, 0.2 - EdgeRamp{}.beyond() * 0.05, 1e-12);
  EXPECT_NEAR(high, 0.6 + EdgeRamp{}.beyond() * 0.05, 1e-12);
  // Attached to the wall y = 0.2: closed there, two cells further.
  sheet.attached = {{{0.2, 0.2, 0}, {0.4, 0.2, 1}}};
  BodySurfaces attached({sheet}, flat_box);
  const BodySurface held = attached.at(0)[0];
  for (std::size_t c = 0; c < held.position.size(); ++c)
    if (held.position[c][1] < 0.3) {
      EXPECT_EQ(held.opening[c], 0);
    }
  low = 1;
  for (const Point& p : held.position) low = std::min(low, p[1]);
  EXPECT_NEAR(low, 0.2 - 0.1, 1e-12);
}

TEST(BodySurfaces, MoveFromOutsideAlongTheCubicBetweenBothEndsOfAStep) {
  const BodySetup setup = plate();
  BodySurfaces bodies({setup}, box);
  const auto height = [&](double time) { return bodies.at(time)[0].position[0][2]; };
  const auto speed = [&](double time) { return bodies.at(time)[0].velocity[0][2]; };
  bodies.set_motion(0, motion_at(0.1, setup, 0.02, 0.7));
  EXPECT_DOUBLE_EQ(height(0), 0.5);
  EXPECT_DOUBLE_EQ(speed(0), 0);
  EXPECT_NEAR(height(0.1), 0.52, 1e-15);
  EXPECT_NEAR(speed(0.1), 0.7, 1e-14);
  EXPECT_NEAR(speed(0.2), 0.7, 1e-14);
  EXPECT_NEAR(speed(0.04), 0.4 * 0.7, 1e-14);  // in proportion, though places lie on a cubic
  EXPECT_NEAR(height(0.05), 0.5 + 0.01 - 0.1 * 0.7 / 8, 1e-14);
  // Tried again with another end, from the same start.
  bodies.set_motion(0, motion_at(0.1, setup, 0.03, 0.2));
  EXPECT_DOUBLE_EQ(height(0), 0.5);
  EXPECT_NEAR(height(0.1), 0.53, 1e-15);
  // And once more, from all but the same place: its velocity is taken, a move of less than 1e-3 cells is not, nor that
  // of places within the step.
  bodies.set_motion(0, motion_at(0.1, setup, 0.03 + 1e-6, 0.3));
  EXPECT_NEAR(height(0.1), 0.53, 1e-15);
  EXPECT_NEAR(height(0.05), 0.5 + 0.015 - 0.1 * 0.2 / 8, 1e-14);
  EXPECT_NEAR(speed(0.1), 0.3, 1e-14);
  bodies.set_motion(0, motion_at(0.1, setup, 0.031, 0.2));
  EXPECT_NEAR(height(0.1), 0.531, 1e-15);
  bodies.set_motion(0, motion_at(0.1, setup, 0.03, 0.2));
  bodies.accept_motion();
  bodies.set_motion(0, motion_at(0.2, setup, 0.05, 0.4));
  EXPECT_NEAR(height(0.1), 0.53, 1e-15);
  EXPECT_NEAR(speed(0.15), 0.3, 1e-13);
  EXPECT_NEAR(speed(0.2), 0.4, 1e-14);
  // After a restart.
  BodySurfaces again({setup}, box);
  again.set_start(0, *bodies.start(0));
  again.set_motion(0, motion_at(0.2, setup, 0.05, 0.4));
  EXPECT_EQ(again.at(0.137)[0].position, bodies.at(0.137)[0].position);
  EXPECT_EQ(again.at(0.137)[0].velocity, bodies.at(0.137)[0].velocity);
}

TEST(BodySurfaces, CarryForcesToNodesWithTheirWork) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  BodySetup thick = plate();
  thick.thickness = 0.1;
  for (const BodySetup& setup :
       {plate(), thick, body_of("ball", make_ellipsoid({0.5, 0.5, 0.5}, {0.2, 0.2, 0.2}, 0.2), true)}) {
    BodySurfaces bodies({setup}, box);
    NodalMotion end = motion_at(0.1, setup, 0, 0);
    for (auto& u : end.velocity.reshaped()) u = number(random);
    for (auto& x : end.displacement.reshaped()) x = 0.01 * number(random);
    bodies.set_motion(0, end);
    const BodySurface surface = bodies.at(0.1)[0];
    EXPECT_EQ(surface.is_closed, setup.is_closed || setup.thickness > 0);
    std::vector<Point> force(surface.position.size());
    double work = 0;
    for (std::size_t c = 0; c < force.size(); ++c) {
      force[c] = {number(random), number(random), number(random)};
      work += dot(force[c], surface.velocity[c]);
    }
    const surface::NodeArray nodal = bodies.nodal_force(0, force);
    EXPECT_NEAR(nodal.cwiseProduct(end.velocity).sum(), work, 1e-10);  // round-off of some thousand forces of 1
  }
}

TEST(BodySurfaces, RefuseWhatCannotBe) {
  EXPECT_THROW(BodySurfaces({plate(), plate()}, box), report::SceneError);
  BodySetup closed_plate = plate();
  closed_plate.is_closed = true;
  EXPECT_THROW(BodySurfaces({closed_plate}, box), report::SceneError);
  BodySetup thick_ball = body_of("ball", make_ellipsoid({0.5, 0.5, 0.5}, {0.2, 0.2, 0.2}, 0.2), true);
  thick_ball.thickness = 0.1;
  EXPECT_THROW(BodySurfaces({thick_ball}, box), report::SceneError);
  BodySetup moving = plate();
  FourierSeries swing;
  swing.sine = {0.1};
  moving.motion = PrescribedMotion({Translation{{TimeFunction(swing), TimeFunction(0.0), TimeFunction(0.0)}}});
  BodySurfaces bodies({moving, body_of("other", plate().mesh, false)}, box);
  EXPECT_THROW(bodies.set_motion(0, motion_at(0.1, moving, 0, 0)), report::SceneError);
  EXPECT_THROW(bodies.set_motion(1, motion_at(0, moving, 0, 0)), report::SceneError);  // not behind the start
  EXPECT_THROW(bodies.set_motion(1, {0.1, surface::NodeArray::Zero(3, 3), surface::NodeArray::Zero(3, 3)}),
               report::SceneError);
}

}  // namespace
}  // namespace couplet::flow
