#include "flow-server/immersed/moving_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;

/// Cells of 0.1 along x, 0.05 along y.
StretchedGrid channel(int n_dimensions) {
  const StretchedAxis z =
      n_dimensions == 3 ? StretchedAxis(uniform_faces(0, 1, 20), false) : StretchedAxis({0, 7}, false);
  return {{StretchedAxis(uniform_faces(-2, 2, 40), false), StretchedAxis(uniform_faces(0, 1, 20), false), z},
          n_dimensions};
}

BodySetup upright_plate() {
  BodySetup body;
  body.name = "plate";
  body.mesh = make_rectangle({0, 0, 0.2}, {0, 1, 0}, {0, 0, 0.5}, 0.05);
  body.is_closed = false;
  body.largest_side = 0.05;
  return body;
}

TEST(MovingSurface, KnowsTheGrid) {
  const StretchedGrid grid = channel(3);
  EXPECT_EQ(border_planes(grid).size(), 6u);
  EXPECT_NEAR(cell_width_at(grid, {0.5, 0.5, 0.5}), 0.1, 1e-12);
  EXPECT_NEAR(cell_width_at(grid, {50, -3, 0.5}), 0.1, 1e-12);          // outside: that of the border
  EXPECT_NEAR(cell_width_at(channel(2), {0.5, 0.5, 0.5}), 0.1, 1e-12);  // not the depth
}

TEST(MovingSurface, ASheetFromWallToWallEndsOnThemAndOpensAtItsFreeEdges) {
  const StretchedGrid grid = channel(3);
  const MovingSurface moving(upright_plate(), grid);
  EXPECT_TRUE(moving.notes().empty());
  for (const FreeEdge& edge : moving.free_edges()) {
    const double z = moving.body().position[static_cast<std::size_t>(edge.from)][2];
    EXPECT_TRUE(z == 0.2 || z == 0.7);  // not those on y = 0 and y = 1
  }
  const BodySurface& surface = moving.surface();
  EXPECT_GT(surface.position.size(), moving.body().position.size());
  double low = 1, high = 0;
  for (const Point& p : surface.position) low = std::min(low, p[2]), high = std::max(high, p[2]);
  // Half a ramp of two cells, its shift of 0.13, and 1.5 cells that are fully open; cells are 0.1 wide.
  EXPECT_NEAR(low, 0.2 - 0.263, 1e-12);
  EXPECT_NEAR(high, 0.7 + 0.263, 1e-12);
}

TEST(MovingSurface, MovesAsPrescribedAndAsItsNodesDo) {
  const StretchedGrid grid = channel(3);
  BodySetup body = upright_plate();
  body.motion =
      PrescribedMotion({Translation{{FourierSeries{.frequency = 1, .cosine = {0.3}, .sine = {0.1}}, 0.0, 0.0}}});
  MovingSurface moving(body, grid);
  EXPECT_NEAR(moving.surface().position[0][0], 0.3, 1e-15);  // where the motion is at time 0
  moving.move_to(0.25);
  for (std::size_t c = 0; c < moving.surface().position.size(); ++c) {
    EXPECT_NEAR(moving.surface().position[c][0], 0.1, 1e-14);
    EXPECT_NEAR(moving.surface().velocity[c][0], -0.3 * 2 * pi, 1e-13);
  }
  const surface::NodeArray velocity = surface::NodeArray::Constant(body.mesh.n_nodes(), 3, 2);
  moving.follow(body.mesh.node_position, velocity);
  EXPECT_EQ(moving.surface().position[0][0], 0);
  EXPECT_NEAR(moving.surface().velocity.back()[1], 2, 1e-13);

  std::vector<Point> force(moving.surface().position.size(), Point{1, 2, 3});
  surface::NodeArray nodal;
  moving.gather(force, nodal);
  EXPECT_NEAR(nodal.col(2).sum(), 3.0 * static_cast<double>(force.size()), 1e-9);  // thousands of terms
}

TEST(MovingSurface, AThickSheetIsAClosedBody) {
  const StretchedGrid grid = channel(3);
  BodySetup body = upright_plate();
  body.thickness = 0.08;
  body.motion =
      PrescribedMotion({Rotation{{0, 0, 0.45}, {0, 1, 0}, FourierSeries{.frequency = 1, .cosine = {}, .sine = {0.5}}}});
  MovingSurface moving(body, grid);
  BodySurface surface = moving.surface();
  const std::vector<BorderPlane> planes = border_planes(grid);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, planes);
  EXPECT_TRUE(topology.notes.empty());
  EXPECT_NEAR(topology.volume, 0.08 * 0.5, 1e-14);
  // It moves rigidly with the sheet: the outer side keeps half the thickness from it.
  moving.move_to(0.1);
  const RigidPose pose = body.motion.pose(0.1);
  for (std::size_t c = 0; c < surface.position.size(); ++c) {
    const Eigen::Vector3d at_rest = Eigen::Vector3d::Map(surface.position[c].data());
    const Eigen::Vector3d now = pose.rotation * at_rest + pose.shift,
                          speed = pose.rotation_rate * at_rest + pose.shift_rate;
    EXPECT_NEAR((now - Eigen::Vector3d::Map(moving.surface().position[c].data())).norm(), 0, 1e-14);
    EXPECT_NEAR((speed - Eigen::Vector3d::Map(moving.surface().velocity[c].data())).norm(), 0, 1e-13);
  }
}

TEST(MovingSurface, RefusesAttachedEdgesWhereThereAreNone) {
  const StretchedGrid grid = channel(3);
  BodySetup body = upright_plate();
  body.attached = {{{-1, -1, 0.65}, {1, 2, 0.75}}};
  EXPECT_NO_THROW(MovingSurface(body, grid));
  body.attached.push_back({{-1, -1, 0.4}, {1, 2, 0.5}});
  try {
    const MovingSurface moving(body, grid);
    FAIL() << "was accepted";
  } catch (const report::SceneError& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("body 'plate': box 1 of its attached edges holds none"));
  }
}

TEST(MovingSurface, ABodyInTwoDimensionsSpansTheCell) {
  const StretchedGrid grid = channel(2);
  BodySetup body;
  body.name = "rod";
  body.mesh = make_elliptic_cylinder({0, 0.5}, {0.2, 0.2}, {0, 7, true}, 0.05);
  body.largest_side = 0.05;
  const MovingSurface moving(body, grid);
  EXPECT_EQ(moving.surface().triangle.size(), static_cast<std::size_t>(body.mesh.n_faces()));  // not cut along z
  EXPECT_TRUE(moving.free_edges().empty());
}

}  // namespace
}  // namespace couplet::flow
