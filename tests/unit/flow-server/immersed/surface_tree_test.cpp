#include "flow-server/immersed/surface_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

SurfaceInTree in_tree(const BodySurface& surface, std::span<const FreeEdge> free_edge = {}) {
  return {&surface, free_edge, static_cast<int>(surface.triangle.size())};
}

/// Distance from a triangle by trying its plane, its sides and its corners one after another.
double plain_distance(const Point& p, const Point& a, const Point& b, const Point& c) {
  double nearest = std::min({distance(p, a), distance(p, b), distance(p, c)});
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
    const Point along = to - from;
    const double s = dot(p - from, along) / dot(along, along);
    if (s > 0 && s < 1) nearest = std::min(nearest, distance(p, from + s * along));
  }
  const Point area = area_vector(a, b, c);
  const Point normal = (1 / length(area)) * area;
  const double height = dot(p - a, normal);
  const Point foot = p - height * normal;
  if (dot(area_vector(a, b, foot), area) >= 0 && dot(area_vector(b, c, foot), area) >= 0 &&
      dot(area_vector(c, a, foot), area) >= 0)
    nearest = std::min(nearest, std::abs(height));
  return nearest;
}

double brute_force(std::span<const SurfaceInTree> surfaces, const Point& p) {
  double nearest = 1e300;
  for (const SurfaceInTree& entry : surfaces) {
    for (int t = 0; t < entry.n_triangles; ++t) {
      const auto& [a, b, c] = entry.surface->triangle[static_cast<std::size_t>(t)];
      nearest = std::min(nearest, plain_distance(p, entry.surface->position[static_cast<std::size_t>(a)],
                                                 entry.surface->position[static_cast<std::size_t>(b)],
                                                 entry.surface->position[static_cast<std::size_t>(c)]));
    }
  }
  return nearest;
}

/// Distances as brute force finds them, whatever the hint; the answer's parts agree with each other.
void expect_as_brute_force(const SurfaceTree& tree, std::span<const SurfaceInTree> surfaces, int n_points) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> any(-2, 2);
  for (int i = 0; i < n_points; ++i) {
    const Point p{any(random), any(random), any(random)};
    const ClosestPoint found = tree.closest(p, 10);
    ASSERT_TRUE(found.is_found());
    EXPECT_NEAR(found.distance, brute_force(surfaces, p), 1e-9);  // of ties within 5e-10 the first counts
    const BodySurface& surface = *surfaces[static_cast<std::size_t>(found.surface)].surface;
    Point at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int corner = surface.triangle[static_cast<std::size_t>(found.triangle)][k];
      at = at + found.weight[k] * surface.position[static_cast<std::size_t>(corner)];
    }
    EXPECT_LT(distance(at, found.position), 1e-14);
    EXPECT_NEAR(distance(p, at), found.distance, 1e-14);
    const ClosestPoint again =
        tree.closest(p, 10, static_cast<int>(random() % static_cast<unsigned>(tree.n_triangles())));
    EXPECT_EQ(again.surface, found.surface);
    EXPECT_EQ(again.triangle, found.triangle);
    EXPECT_EQ(again.position, found.position);
  }
}

TEST(SurfaceTree, FindsWhatBruteForceFindsOnSeveralSurfaces) {
  const BodySurface ball = surface_of(make_ellipsoid({0, 0, 0}, {1, 0.5, 0.7}, 0.15), true);
  const BodySurface plate = surface_of(make_rectangle({-1, -1, 0.9}, {2, 0, 0.3}, {0, 2, 0}, 0.2), false);
  const std::vector<SurfaceInTree> surfaces = {in_tree(ball), in_tree(plate)};
  expect_as_brute_force(SurfaceTree(surfaces), surfaces, 400);
}

TEST(SurfaceTree, WorksForFewTrianglesAndForNone) {
  for (const double side : {3.0, 0.8, 0.5}) {
    const BodySurface box = surface_of(make_box({-1, -1, -1}, {1, 1, 1}, side), true);
    const std::vector<SurfaceInTree> surfaces = {in_tree(box)};
    expect_as_brute_force(SurfaceTree(surfaces), surfaces, 50);
  }
  const BodySurface one{.name = "one",
                        .is_closed = false,
                        .position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                        .velocity = {},
                        .triangle = {{0, 1, 2}},
                        .opening = {}};
  const std::vector<SurfaceInTree> single = {in_tree(one)};
  expect_as_brute_force(SurfaceTree(single), single, 50);
  EXPECT_FALSE(SurfaceTree({}).closest({0, 0, 0}, 1).is_found());
}

TEST(SurfaceTree, FindsNothingBeyondTheLargestDistance) {
  const BodySurface ball = surface_of(make_ellipsoid({0, 0, 0}, {1, 1, 1}, 0.1), true);
  const SurfaceTree tree(std::vector<SurfaceInTree>{in_tree(ball)});
  EXPECT_FALSE(tree.closest({1.5, 0, 0}, 0.49).is_found());
  EXPECT_TRUE(tree.closest({1.5, 0, 0}, 0.51).is_found());
  EXPECT_FALSE(tree.closest({1.5, 0, 0}, 0.49, 0).is_found());  // a hint that is too far off either
}

TEST(SurfaceTree, FollowsSurfacesThatMoveAndDeform) {
  BodySurface ball = surface_of(make_ellipsoid({0, 0, 0}, {1, 0.5, 0.7}, 0.15), true);
  const std::vector<SurfaceInTree> surfaces = {in_tree(ball)};
  SurfaceTree tree(surfaces);
  for (int step = 0; step < 3; ++step) {
    for (Point& p : ball.position) p = {p[0] + 0.3, 0.8 * p[1] + 0.3 * std::sin(4 * p[0]), p[2]};
    tree.refit(surfaces);
    expect_as_brute_force(tree, surfaces, 100);
  }
  // Folded so that a new tree is needed: corners far apart change places.
  for (std::size_t i = 0; i < ball.position.size(); ++i)
    std::swap(ball.position[i], ball.position[i * 7919 % ball.position.size()]);
  tree.refit(surfaces);
  expect_as_brute_force(tree, surfaces, 20);
}

TEST(SurfaceTree, TellsWhatLiesBeyondAFreeEdge) {
  BodySurface plate = surface_of(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.2), false);
  const auto free_edge = orient_surface(plate, FluidSide::outside, {}).free_edge;
  const SurfaceTree tree(std::vector<SurfaceInTree>{in_tree(plate, free_edge)});
  EXPECT_TRUE(tree.closest({1.1, 0.53, 0.1}, 1).is_on_free_edge);
  EXPECT_TRUE(tree.closest({1.1, 1.1, 0.1}, 1).is_on_free_edge);  // beyond a corner
  EXPECT_FALSE(tree.closest({0.95, 0.53, 0.3}, 1).is_on_free_edge);
  EXPECT_FALSE(tree.closest({0.2, 0.2, 0.3}, 1).is_on_free_edge);
  // Without the last triangles the sheet ends where they began, but no edge is known to be free there.
  const SurfaceTree part(std::vector<SurfaceInTree>{{&plate, {}, 10}});
  EXPECT_EQ(part.n_triangles(), 10);
}

}  // namespace
}  // namespace couplet::flow
