#include "flow-server/immersed/surface_topology.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;

BodySurface ball(double side) {
  return surface_of(make_ellipsoid({0, 0, 0}, {1, 1, 1}, side), true);
}

void swap_sides(BodySurface& surface, std::size_t triangle) {
  std::swap(surface.triangle[triangle][0], surface.triangle[triangle][1]);
}

std::string refusal(BodySurface surface) {
  try {
    orient_surface(surface, FluidSide::outside, {});
  } catch (const report::SceneError& failure) {
    return failure.what();
  }
  return "accepted";
}

TEST(SurfaceTopology, ABallIsClosedAndFacesOutwards) {
  BodySurface surface = ball(0.1);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  EXPECT_TRUE(topology.free_edge.empty());
  EXPECT_TRUE(topology.notes.empty());
  EXPECT_EQ(topology.n_parts, 1);
  EXPECT_NEAR(topology.volume, 4 * std::numbers::pi / 3, 0.02);
  for (std::size_t t = 0; t < surface.triangle.size(); ++t)
    for (const int other : topology.neighbour[t]) ASSERT_GE(other, 0);
}

TEST(SurfaceTopology, TurnsTheFewerTrianglesAndSaysSo) {
  BodySurface surface = ball(0.3);
  const auto as_made = surface.triangle;
  for (std::size_t t = 0; t < surface.triangle.size(); t += 7) swap_sides(surface, t);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  ASSERT_EQ(topology.notes.size(), 1u);
  EXPECT_THAT(topology.notes[0], HasSubstr("faced the other way"));
  EXPECT_GT(topology.volume, 4);
  for (std::size_t t = 0; t < surface.triangle.size(); ++t) {
    // The same side of each triangle's plane as it was made.
    const auto area = [&](const std::array<int, 3>& corners) {
      return area_vector(surface.position[static_cast<std::size_t>(corners[0])],
                         surface.position[static_cast<std::size_t>(corners[1])],
                         surface.position[static_cast<std::size_t>(corners[2])]);
    };
    ASSERT_GT(dot(area(surface.triangle[t]), area(as_made[t])), 0);
  }
}

TEST(SurfaceTopology, NeighboursLieAcrossTheirSidesAfterRepair) {
  BodySurface surface = ball(0.5);
  for (std::size_t t = 0; t < surface.triangle.size(); t += 3) swap_sides(surface, t);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  for (std::size_t t = 0; t < surface.triangle.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& other = surface.triangle[static_cast<std::size_t>(topology.neighbour[t][k])];
      const int from = surface.triangle[t][k], to = surface.triangle[t][(k + 1) % 3];
      bool goes_back = false;
      for (std::size_t i = 0; i < 3; ++i) goes_back = goes_back || (other[i] == to && other[(i + 1) % 3] == from);
      EXPECT_TRUE(goes_back) << t << " " << k;
    }
  }
}

TEST(SurfaceTopology, TurnsABodyThatIsInsideOut) {
  BodySurface surface = ball(0.3);
  for (std::size_t t = 0; t < surface.triangle.size(); ++t) swap_sides(surface, t);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  ASSERT_EQ(topology.notes.size(), 1u);
  EXPECT_THAT(topology.notes[0], HasSubstr("was inside out"));
  EXPECT_GT(enclosed_volume(surface, {}), 4);
  // A vessel faces its fluid inside.
  EXPECT_LT(orient_surface(surface, FluidSide::inside, {}).volume, -4);
}

TEST(SurfaceTopology, KeepsACavity) {
  BodySurface surface = ball(0.3);
  const BodySurface inner = ball(0.3);
  const auto n = static_cast<int>(surface.position.size());
  for (const Point& p : inner.position) surface.position.push_back(0.5 * p);
  for (const auto& [a, b, c] : inner.triangle) surface.triangle.push_back({n + a, n + c, n + b});
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  EXPECT_EQ(topology.n_parts, 2);
  EXPECT_THAT(topology.notes, testing::ElementsAre(HasSubstr("a cavity")));
  EXPECT_NEAR(topology.volume / enclosed_volume(ball(0.3), {}), 1 - 0.125, 1e-12);
}

TEST(SurfaceTopology, RefusesAHoleByItsEdge) {
  BodySurface surface = surface_of(make_box({0, 0, 0}, {1, 1, 1}, 10), true);
  surface.triangle.erase(surface.triangle.begin());
  const std::string sentence = refusal(surface);
  EXPECT_THAT(sentence, HasSubstr("surface 'test'"));
  EXPECT_THAT(sentence, HasSubstr("has a hole: the edge from ("));
  EXPECT_THAT(sentence, HasSubstr("like 2 others"));
  EXPECT_THAT(sentence, HasSubstr("call the surface thin"));
}

TEST(SurfaceTopology, RefusesWhatIsNoSurface) {
  BodySurface fin = surface_of(make_box({0, 0, 0}, {1, 1, 1}, 10), false);
  fin.position.push_back({5, 5, 5});
  fin.triangle.push_back({fin.triangle[0][0], fin.triangle[0][1], static_cast<int>(fin.position.size()) - 1});
  EXPECT_THAT(refusal(fin), HasSubstr("belongs to 3 triangles"));

  BodySurface flat = surface_of(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 10), false);
  flat.position.push_back({2, 0, 0});
  flat.triangle.push_back({0, 1, 4});
  EXPECT_THAT(refusal(flat), HasSubstr("has no area"));

  BodySurface moebius{
      .name = "strip", .is_closed = false, .position = {}, .velocity = {}, .triangle = {}, .opening = {}};
  constexpr int n = 12;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, half = angle / 2;
    for (const double s : {-0.3, 0.3}) {
      moebius.position.push_back(
          {(1 + s * std::cos(half)) * std::cos(angle), (1 + s * std::cos(half)) * std::sin(angle), s * std::sin(half)});
    }
  }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i, b = 2 * i + 1;
    const int c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;  // turned over where it closes
    moebius.triangle.push_back({a, c, b});
    moebius.triangle.push_back({b, c, d});
  }
  EXPECT_THAT(refusal(moebius), HasSubstr("has one side only"));
}

TEST(SurfaceTopology, APrismIsClosedByTheBordersThatItEndsOn) {
  const std::vector<BorderPlane> planes = {{0, -5}, {0, 5}, {2, 0}, {2, 0.25}};
  BodySurface surface = surface_of(make_elliptic_cylinder({1, 2}, {0.5, 0.25}, {0, 0.25, true}, 0.01), true);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, planes);
  EXPECT_TRUE(topology.free_edge.empty());
  EXPECT_EQ(topology.border_edge.size(), surface.triangle.size());  // a rim side for each triangle
  EXPECT_EQ(topology.border_plane.size(), 2u);
  EXPECT_NEAR(topology.volume, std::numbers::pi * 0.5 * 0.25 * 0.25, 1e-4);
  EXPECT_THAT(refusal(surface), HasSubstr("has a hole"));
}

TEST(SurfaceTopology, ATubeBetweenBordersHoldsItsFluidInside) {
  const std::vector<BorderPlane> planes = {{0, 0}, {0, 3}, {1, -2}, {1, 2}};
  BodySurface surface = surface_of(make_tube({0, 0, 0}, {3, 0, 0}, 1, 0.1), true);
  const SurfaceTopology topology = orient_surface(surface, FluidSide::inside, planes);
  EXPECT_TRUE(topology.notes.empty());
  EXPECT_NEAR(topology.volume, -3 * std::numbers::pi, 0.02);
}

TEST(SurfaceTopology, ASheetHasItsRimAsFreeEdges) {
  BodySurface sheet = surface_of(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 0.2), false);
  const SurfaceTopology topology = orient_surface(sheet, FluidSide::outside, {});
  double rim = 0;
  for (const FreeEdge& edge : topology.free_edge) {
    rim += distance(sheet.position[static_cast<std::size_t>(edge.from)],
                    sheet.position[static_cast<std::size_t>(edge.to)]);
    const auto& corners = sheet.triangle[static_cast<std::size_t>(edge.triangle)];
    bool in_order = false;
    for (std::size_t k = 0; k < 3; ++k)
      in_order = in_order || (corners[k] == edge.from && corners[(k + 1) % 3] == edge.to);
    EXPECT_TRUE(in_order);
  }
  EXPECT_NEAR(rim, 4, 1e-12);
}

TEST(SurfaceTopology, AMillionTrianglesTakeAboutASecond) {
  BodySurface surface = ball(0.0050);
  ASSERT_GT(surface.triangle.size(), 1000000u);
  const auto start = std::chrono::steady_clock::now();
  const SurfaceTopology topology = orient_surface(surface, FluidSide::outside, {});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(topology.n_parts, 1);
  RecordProperty("seconds", std::to_string(taken.count()));
  EXPECT_LT(taken.count(), 10);  // guards against squares; the measured time is about half a second
}

}  // namespace
}  // namespace couplet::flow
