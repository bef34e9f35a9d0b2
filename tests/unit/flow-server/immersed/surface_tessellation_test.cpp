#include "flow-server/immersed/surface_tessellation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "flow-server/immersed/surface_topology.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

surface::SurfaceMesh mesh_of(const std::vector<Point>& nodes, const std::vector<std::vector<int>>& faces) {
  surface::SurfaceMesh mesh;
  mesh.node_position.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d)
      mesh.node_position(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) = nodes[i][d];
  std::vector<std::int64_t> offset{0}, node;
  for (const auto& face : faces) {
    node.insert(node.end(), face.begin(), face.end());
    offset.push_back(static_cast<std::int64_t>(node.size()));
  }
  mesh.face_offset = Eigen::Map<surface::IndexArray>(offset.data(), static_cast<Eigen::Index>(offset.size()));
  mesh.face_node = Eigen::Map<surface::IndexArray>(node.data(), static_cast<Eigen::Index>(node.size()));
  mesh.face_region.setZero(static_cast<Eigen::Index>(faces.size()));
  mesh.region = {"all"};
  return mesh;
}

/// A round shell of radius 1 and height 1 of n x 1 quadratic quadrilaterals, midside nodes on the circle; closed
/// around.
surface::SurfaceMesh quadratic_shell(int n) {
  std::vector<Point> nodes;
  std::vector<std::vector<int>> faces;
  const auto add = [&](double step, double z) {
    const double angle = 2 * std::numbers::pi * step / n;
    nodes.push_back({std::cos(angle), std::sin(angle), z});
  };
  // Five nodes a sector: two corners, the middle of its upright side, two middles of its round sides.
  for (int i = 0; i < n; ++i) add(i, 0), add(i, 1), add(i, 0.5), add(i + 0.5, 0), add(i + 0.5, 1);
  for (int i = 0; i < n; ++i) {
    const int a = 5 * i, b = 5 * ((i + 1) % n);
    faces.push_back({a, b, b + 1, a + 1, a + 3, b + 2, a + 4, a + 2});
  }
  return mesh_of(nodes, faces);
}

double area_of(const SurfaceTessellation& tessellation, const std::vector<Point>& position) {
  double area = 0;
  for (const auto& [a, b, c] : tessellation.triangle()) {
    area += length(area_vector(position[static_cast<std::size_t>(a)], position[static_cast<std::size_t>(b)],
                               position[static_cast<std::size_t>(c)]));
  }
  return area;
}

TEST(SurfaceTessellation, FollowsCurvedFacesLargerThanACell) {
  const surface::SurfaceMesh mesh = quadratic_shell(6);
  // The area of the faces themselves, not of the circle: by a very fine cut.
  std::vector<double> area;
  for (const double side : {0.4, 0.2, 0.1, 0.0125}) {
    const SurfaceTessellation tessellation(mesh, "shell", {.largest_side = side});
    std::vector<Point> position;
    tessellation.interpolate(mesh.node_position, position);
    area.push_back(area_of(tessellation, position));
    for (const auto& corners : tessellation.triangle()) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LE(distance(position[static_cast<std::size_t>(corners[k])],
                           position[static_cast<std::size_t>(corners[(k + 1) % 3])]),
                  side * (1 + 1e-8));
      }
    }
  }
  // Chords instead of arcs: second order, a factor of 4 for half the side, 3 to 5.5 as halving makes sides uneven.
  EXPECT_GT((area[3] - area[0]) / (area[3] - area[1]), 3);
  EXPECT_LT(area[3] - area[2], 0.002 * area[3]);
  EXPECT_NEAR(area[3], 2 * std::numbers::pi, 0.01 * 2 * std::numbers::pi);  // six parabolas around a circle
}

TEST(SurfaceTessellation, LeavesNoGapWhenTheNodesMoveAnyhow) {
  const surface::SurfaceMesh mesh = quadratic_shell(5);
  const SurfaceTessellation tessellation(mesh, "shell", {.largest_side = 0.15});
  surface::NodeArray moved = mesh.node_position;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-0.05, 0.05);
  for (Eigen::Index i = 0; i < moved.size(); ++i) moved(i) += shift(random);
  BodySurface surface{
      .name = "shell", .is_closed = false, .position = {}, .velocity = {}, .triangle = {}, .opening = {}};
  surface.triangle = tessellation.triangle();
  tessellation.interpolate(moved, surface.position);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  EXPECT_EQ(topology.n_parts, 1);
  // Every free edge lies on one of the two rims, whose nodes are those of z = 0 and z = 1: no inner edge is free.
  std::vector<Point> at_rest;
  tessellation.interpolate(mesh.node_position, at_rest);
  for (const FreeEdge& edge : topology.free_edge) {
    const double z = at_rest[static_cast<std::size_t>(edge.from)][2];
    EXPECT_EQ(z, at_rest[static_cast<std::size_t>(edge.to)][2]);
    EXPECT_TRUE(z == 0 || z == 1);
  }
}

TEST(SurfaceTessellation, CutsNeighboursOfOtherSizesAndKindsAlike) {
  // A quadratic quadrilateral, a triangle, a quadratic triangle and a quadrilateral beside each other, of unlike
  // lengths.
  const surface::SurfaceMesh mesh = mesh_of({{0, 0, 0},
                                             {1, 0, 0},
                                             {1, 1, 0},
                                             {0, 1, 0},
                                             {0.5, 0, 0},
                                             {1, 0.5, 0},
                                             {0.5, 1, 0.2},
                                             {0, 0.5, 0},
                                             {0.5, 3, 0},
                                             {0.25, 2, 0.1},
                                             {0.75, 2, 0.1},
                                             {-4, 0, 0},
                                             {-4, 1, 0}},
                                            {{0, 1, 2, 3, 4, 5, 6, 7}, {3, 2, 8, 6, 10, 9}, {11, 0, 3, 12}});
  BodySurface surface{
      .name = "mixed", .is_closed = false, .position = {}, .velocity = {}, .triangle = {}, .opening = {}};
  const SurfaceTessellation tessellation(mesh, "mixed", {.largest_side = 0.3});
  surface.triangle = tessellation.triangle();
  tessellation.interpolate(mesh.node_position, surface.position);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  EXPECT_EQ(topology.n_parts, 2);  // the quadrilateral's side 0-3 has no middle node, the quadratic face's has
  EXPECT_TRUE(topology.notes.empty());
  // Edges along the shared quadratic side (y about 1, x from 0 to 1) are not free.
  for (const FreeEdge& edge : topology.free_edge) {
    const Point middle = 0.5 * (surface.position[static_cast<std::size_t>(edge.from)] +
                                surface.position[static_cast<std::size_t>(edge.to)]);
    EXPECT_FALSE(std::abs(middle[1] - 1) < 1e-9 && middle[0] > 0 && middle[0] < 1) << middle[0];
  }
}

TEST(SurfaceTessellation, GatherIsTheTransposeOfInterpolate) {
  const surface::SurfaceMesh mesh = quadratic_shell(7);
  const SurfaceTessellation tessellation(mesh, "shell", {.largest_side = 0.2});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  surface::NodeArray nodal_velocity = mesh.node_position, nodal_force;
  for (Eigen::Index i = 0; i < nodal_velocity.size(); ++i) nodal_velocity(i) = any(random);
  std::vector<Point> velocity, force(static_cast<std::size_t>(tessellation.n_corners()));
  for (Point& f : force) f = {any(random), any(random), any(random)};
  tessellation.interpolate(nodal_velocity, velocity);
  tessellation.gather(force, nodal_force);
  double power = 0;
  Point sum{};
  for (std::size_t c = 0; c < force.size(); ++c) power += dot(force[c], velocity[c]), sum = sum + force[c];
  // Sums of a few thousand terms of order 1.
  EXPECT_NEAR((nodal_force.array() * nodal_velocity.array()).sum(), power, 1e-11);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(nodal_force.col(d).sum(), sum[static_cast<std::size_t>(d)], 1e-11);
}

TEST(SurfaceTessellation, CutsPrismsAcrossZAlone) {
  // Two quadrilaterals, quadratic and not, round a corner; one begins with a side along z.
  const surface::SurfaceMesh mesh = mesh_of({{0, 0, 0},
                                             {1, 0, 0},
                                             {1, 0, 5},
                                             {0, 0, 5},
                                             {0.5, -0.1, 0},
                                             {1, 0, 2.5},
                                             {0.5, -0.1, 5},
                                             {0, 0, 2.5},
                                             {1, 2, 0},
                                             {1, 2, 5}},
                                            {{0, 1, 2, 3, 4, 5, 6, 7}, {2, 1, 8, 9}});
  BodySurface surface{
      .name = "plate", .is_closed = false, .position = {}, .velocity = {}, .triangle = {}, .opening = {}};
  const SurfaceTessellation tessellation(mesh, "plate", {.largest_side = 0.25, .is_two_dimensional = true});
  surface.triangle = tessellation.triangle();
  tessellation.interpolate(mesh.node_position, surface.position);
  for (const Point& p : surface.position) EXPECT_NEAR(std::abs(p[2] - 2.5), 2.5, 1e-14);
  EXPECT_EQ(surface.triangle.size(), 2u * (6 + 8));  // halves of 0.51 in 3 parts each; 2 in 8
  const SurfaceTopology topology =
      orient_surface(surface, FluidSide::outside, std::vector<BorderPlane>{{2, 0}, {2, 5}});
  EXPECT_EQ(topology.n_parts, 1);
  EXPECT_EQ(topology.free_edge.size(), 2u);
  double least_y = 0;
  for (const Point& p : surface.position) least_y = std::min(least_y, p[1]);
  EXPECT_DOUBLE_EQ(least_y, -0.1);  // through the midside node
  // The faces go round the same way as their triangles do.
  const auto& [a, b, c] = tessellation.triangle()[0];
  EXPECT_LT(area_vector(surface.position[static_cast<std::size_t>(a)], surface.position[static_cast<std::size_t>(b)],
                        surface.position[static_cast<std::size_t>(c)])[1],
            0);
}

TEST(SurfaceTessellation, RefusesWhatTakesTooManyTriangles) {
  const surface::SurfaceMesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  try {
    const SurfaceTessellation tessellation(mesh, "body 'plate'", {.largest_side = 1e-3, .largest_n_triangles = 1000});
    FAIL() << "was accepted";
  } catch (const report::SceneError& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("body 'plate'"));
    EXPECT_THAT(failure.what(), testing::HasSubstr("takes more than 1000"));
  }
}

}  // namespace
}  // namespace couplet::flow
