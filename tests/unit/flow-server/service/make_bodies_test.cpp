#include "flow-server/service/make_bodies.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "flow-server/immersed/body_surfaces.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "flow-server/service/body_speed.hpp"
#include "flow-server/service/make_navier_stokes.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;
constexpr double pi = std::numbers::pi;

StretchedGrid cube(int n_dimensions) {
  const StretchedAxis side(uniform_faces(-1, 1, 20), false);  // cells of 0.1
  return {{side, side, n_dimensions == 3 ? side : StretchedAxis({0, 0.5}, false)}, n_dimensions};
}

std::vector<BodySetup> bodies_from(const std::string& text, int n_dimensions = 3) {
  v1::NavierStokes model;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &model)) << text;
  return make_bodies(model, cube(n_dimensions), 0.01, "/scenes");
}

TEST(MakeBodies, MakesRoundBodiesAcrossAFlowInTwoDimensions) {
  const auto bodies = bodies_from(
      "body { name: 'rod' cylinder { centre { x: 0.2 } radius: 0.3 } "
      "placement { translation { y: 0.1 } } }",
      2);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].name, "rod");
  EXPECT_TRUE(bodies[0].is_closed);
  EXPECT_EQ(bodies[0].blend_width, std::nullopt);
  EXPECT_TRUE(bodies[0].motion.is_fixed());
  EXPECT_NEAR(bodies[0].largest_side, 0.1, 1e-12);  // the difference of two faces
  const auto& nodes = bodies[0].mesh.node_position;
  const double radius = std::hypot(nodes(0, 0) - 0.2, nodes(0, 1) - 0.1);
  int n_corners = 0;
  for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
    EXPECT_NEAR(std::hypot(nodes(i, 0) - 0.2, nodes(i, 1) - 0.1), radius, 1e-15);
    EXPECT_TRUE(nodes(i, 2) == 0 || nodes(i, 2) == 0.5);
    n_corners += nodes(i, 2) == 0 ? 1 : 0;
  }
  // The polygon has the area of the circle.
  EXPECT_NEAR(0.5 * n_corners * radius * radius * std::sin(2 * M_PI / n_corners), M_PI * 0.3 * 0.3, 1e-14);
}

TEST(MakeBodies, EveryShapeIsAsItsWordsSay) {
  const auto bodies = bodies_from(R"(
    body { name: "ball" ellipsoid { centre { x: 0.1 } radius: 0.5 radius_z: 0.2 } }
    body { name: "block" cuboid { low { x: -0.5 } high { y: 0.5 z: 0.5 } } }
    body { name: "wall" tube { start { x: -1 } end { x: 1 } radius: 0.5 } }
    body { name: "beam" polygon { point { } point { x: 0.5 } point { x: 0.5 y: 0.2 } point { y: 0.2 } } }
    body { name: "ellipse" cylinder { radius: 0.4 radius_y: 0.2 } }
    body { name: "cones" revolved { point { x: -0.5 } point { y: 0.4 } point { x: 0.9 } } })");
  ASSERT_EQ(bodies.size(), 6u);
  const std::vector<BorderPlane> borders = {{0, -1}, {0, 1}, {1, -1}, {1, 1}, {2, -1}, {2, 1}};
  // The tube goes on for two cells of 0.1 beyond either border.
  const std::vector<double> volume = {
      4 * pi / 3 * 0.5 * 0.5 * 0.2, 0.5 * 0.5 * 0.5,         -pi * 0.25 * 2.4, 0.5 * 0.2 * 2,
      pi * 0.4 * 0.2 * 2,           pi * 0.4 * 0.4 * 1.4 / 3};
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    BodySurface surface = surface_of(bodies[b].mesh, bodies[b].is_closed);
    const SurfaceTopology topology = orient_surface(surface, bodies[b].fluid, borders);
    EXPECT_TRUE(topology.notes.empty()) << bodies[b].name;
    EXPECT_NEAR(topology.volume, volume[b], 0.02 * std::abs(volume[b])) << bodies[b].name;  // chords of 0.1
  }
}

TEST(MakeBodies, SheetsHaveEdges) {
  const auto bodies = bodies_from(R"(
    body { name: "wing" rectangle { first_side { x: 0.5 } second_side { y: 0.5 } }
           edge { ramp_shift: 0.2 attached { y_to: 0.01 } } thickness: 0.3 }
    body { name: "gate" sheet { point { x: -0.5 y: -1 } point { y: 1 } } edge { all_attached: true attached_length: 0.7 } })");
  EXPECT_FALSE(bodies[0].is_closed);
  EXPECT_EQ(bodies[0].blend_width, std::nullopt);
  EXPECT_NEAR(bodies[0].largest_side, 0.05, 1e-12);
  EXPECT_EQ(bodies[0].edge.length, 2);
  EXPECT_EQ(bodies[0].edge.shift, 0.2);
  EXPECT_EQ(bodies[0].edge_conductance, 1);
  EXPECT_EQ(bodies[0].thickness, 0.3);
  EXPECT_NEAR(bodies[0].attached_length, 0.2, 1e-12);
  ASSERT_EQ(bodies[0].attached.size(), 1u);
  EXPECT_EQ(bodies[0].attached[0].high[1], 0.01);
  EXPECT_EQ(bodies[0].attached[0].low[1], -std::numeric_limits<double>::infinity());
  ASSERT_EQ(bodies[1].attached.size(), 1u);
  EXPECT_EQ(bodies[1].attached[0].high[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(bodies[1].attached_length, 0.7);
}

/// Two sheets far apart in a flow in two dimensions; `first` is said of the first one.
std::unique_ptr<PlacedBodies> two_plates(const std::string& first) {
  const StretchedGrid grid = cube(2);
  BodySurfaces surfaces(
      bodies_from("body { name: 'first' sheet { point { x: -0.53 y: -0.3 } point { x: -0.47 y: 0.3 } } " + first +
                      " } body { name: 'second' sheet { point { x: 0.47 y: -0.3 } point { x: 0.53 y: 0.3 } } }",
                  2),
      grid);
  return std::make_unique<PlacedBodies>(grid, surfaces.at(0));
}

/// Sums over what belongs to each of the two: shares of hybrid velocities, conductances of free edges.
struct OfPlates {
  std::array<double, 2> share{}, conductance{};

  explicit OfPlates(const PlacedBodies& placed) {
    for (const ForcedFace& forced : placed.bodies->layer().forced())
      share[static_cast<std::size_t>(forced.surface)] += forced.share;
    for (const auto& link : placed.bodies->pieces().split().links)
      if (link.a.cell == link.b.cell)  // both sides of a sheet in one cell
        conductance[link.a.cell[0] < 10 ? 0 : 1] += link.conductance;
  }
};

TEST(MakeBodies, BlendAndEdgeOfASceneAreThoseOfThatBodyAlone) {
  const OfPlates usual(*two_plates("")), narrow(*two_plates("blend_width: 0.5")),
      joined(*two_plates("edge { conductance: 3 }"));
  ASSERT_GT(usual.share[1], 1);
  ASSERT_GT(usual.conductance[1], 0);
  // 1 - distance / blend over faces that lie evenly on both sides: proportional to the blend but for how they lie.
  EXPECT_NEAR(narrow.share[0], 0.5 * usual.share[0], 0.1 * usual.share[0]);
  EXPECT_EQ(narrow.share[1], usual.share[1]);
  EXPECT_EQ(narrow.conductance, usual.conductance);
  EXPECT_NEAR(joined.conductance[0], 3 * usual.conductance[0], 1e-12 * usual.conductance[0]);  // round-off of a sum
  EXPECT_EQ(joined.conductance[1], usual.conductance[1]);
  EXPECT_EQ(joined.share, usual.share);
}

TEST(MakeBodies, SpeedOfBodiesIsThatOfTheirFastestPoint) {
  const auto bodies = bodies_from(
      "body { name: 'slow' cylinder { radius: 0.1 } joint { translation { x { expression: '0.2*sin(pi*t)' } } } } "
      "body { name: 'fast' cylinder { centre { x: 0.5 } radius: 0.1 } joint { rotation { angle { expression: '90*t' } "
      "} } } "
      "body { name: 'fixed' cylinder { centre { x: -0.5 } radius: 0.1 } }",
      2);
  const auto fastest = fastest_body(bodies, cube(2), 1);
  ASSERT_TRUE(fastest);
  EXPECT_EQ(fastest->name, "fast");
  EXPECT_NEAR(fastest->speed, 0.6 * pi / 2, 0.01);  // a node within half a triangle of the outermost point
  EXPECT_GE(fastest->cells, fastest->speed / 0.1 * (1 - 1e-6));
  EXPECT_LE(fastest->cells, std::sqrt(2.0) * fastest->speed / 0.1);  // |u| + |v|
  EXPECT_FALSE(note_on_speed(bodies, cube(2), 0.05, 1));
  EXPECT_THAT(note_on_speed(bodies, cube(2), 0.5, 1).value_or(""), HasSubstr("body 'fast' passes up to"));
  EXPECT_FALSE(fastest_body({bodies[2]}, cube(2), 1));
}

TEST(MakeBodies, JointsOfTheCarrierComeFirst) {
  const auto bodies = bodies_from(R"(
    body { name: "trunk" ellipsoid { radius: 0.2 } joint { translation { z { fourier { frequency: 1 sine: 0.1 } } } } }
    body { name: "wing" moves_with: "trunk" rectangle { first_side { x: 0.5 } second_side { y: 0.5 } }
           joint { rotation { through { y: 0.5 } axis { x: 1 } angle { in_time { row { time: 0 value: 0 }
                                                                                row { time: 1 value: 90 } } } } } })");
  const RigidPose pose = bodies[1].motion.pose(0.25);
  // At a quarter of the period: lifted by 0.1, turned by 22.5 degrees about x through y = 0.5, then lifted.
  const double angle = pi / 8;
  const Eigen::Vector3d moved = pose.rotation * Eigen::Vector3d(0, 1, 0) + pose.shift;
  EXPECT_NEAR(moved.y(), 0.5 + 0.5 * std::cos(angle), 1e-15);
  EXPECT_NEAR(moved.z(), 0.1 + 0.5 * std::sin(angle), 1e-15);
  EXPECT_NEAR(pose.angular_velocity().x(), pi / 2, 1e-15);
  EXPECT_EQ(bodies[0].motion.joints().size(), 1u);
}

TEST(MakeBodies, FormulasOfMotionHaveRates) {
  const auto bodies = bodies_from(
      "body { name: 'rod' cylinder { radius: 0.2 } joint { translation { x { expression: 'sin(2*pi*t)' } } } }", 2);
  // The difference of fourth order over 0.02 steps is off by (2 pi 2e-4)^4 / 30; round-off is 1e-16 / 2e-4.
  EXPECT_NEAR(bodies[0].motion.pose(0.1).shift_rate.x(), 2 * pi * std::cos(0.2 * pi), 2e-12);
}

TEST(MakeBodies, PlacesByDegrees) {
  const auto bodies = bodies_from(
      "body { name: 'plate' sheet { point { } point { x: 0.5 } } placement { rotation_axis { z: 1 } "
      "rotation_angle: 90 translation { x: 0.1 } } }",
      2);
  EXPECT_NEAR(bodies[0].mesh.node_position.col(0).maxCoeff(), 0.1, 1e-15);
  EXPECT_NEAR(bodies[0].mesh.node_position.col(1).maxCoeff(), 0.5, 1e-15);
}

TEST(MakeBodies, RefusesAFileThatIsNotThere) {
  try {
    bodies_from("body { name: 'bird' file { file: 'no.stl' kind: CLOSED } }");
    FAIL() << "was accepted";
  } catch (const report::FileError& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("/scenes/no.stl"));
  }
}

}  // namespace
}  // namespace couplet::flow
