#include "flow-server/immersed/sharp_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "flow-server/immersed/body_shape.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

std::vector<SharpEdge> edges_of(const BodySurface& surface) {
  return find_sharp_edges(surface.position, surface.triangle);
}

double length(const BodySurface& surface, const std::vector<SharpEdge>& edges) {
  double sum = 0;
  for (const SharpEdge& edge : edges) {
    const auto& corners = surface.triangle[static_cast<std::size_t>(edge.triangle)];
    const auto at = [&](int end) {
      return surface.position[static_cast<std::size_t>(corners[static_cast<std::size_t>(end)])];
    };
    const Point a = at(edge.end[0]), b = at(edge.end[1]);
    sum += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }
  return sum;
}

TEST(SharpEdges, OfABoxAreItsTwelveSidesEachOnce) {
  const BodySurface box = surface_of(make_box({0, 0, 0}, {0.3, 0.4, 0.5}, 0.11), true);
  const std::vector<SharpEdge> edges = edges_of(box);
  EXPECT_NEAR(length(box, edges), 4 * (0.3 + 0.4 + 0.5), 1e-12);
  for (const SharpEdge& edge : edges) EXPECT_TRUE(edge.is_convex);
}

TEST(SharpEdges, ThatTheFluidFillsAreNotConvex) {
  BodySurface box = surface_of(make_box({0, 0, 0}, {0.3, 0.4, 0.5}, 0.11), true);
  for (auto& corners : box.triangle) std::swap(corners[0], corners[1]);
  const std::vector<SharpEdge> edges = edges_of(box);
  EXPECT_NEAR(length(box, edges), 4 * (0.3 + 0.4 + 0.5), 1e-12);
  for (const SharpEdge& edge : edges) EXPECT_FALSE(edge.is_convex);
}

TEST(SharpEdges, AreNotOnRoundBodiesNorWhereASurfaceEnds) {
  EXPECT_TRUE(edges_of(surface_of(make_ellipsoid({0, 0, 0}, {1, 1, 1}, 0.3), true)).empty());
  // A prism without lids: four edges along z.
  const DepthSpan depth{0, 1, true};
  const BodySurface prism = surface_of(make_polygon_prism({{0, 0}, {0.4, 0}, {0.4, 0.2}, {0, 0.2}}, depth, 0.1), true);
  EXPECT_NEAR(length(prism, edges_of(prism)), 4, 1e-12);
}

}  // namespace
}  // namespace couplet::flow
