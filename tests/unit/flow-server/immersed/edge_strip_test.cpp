#include "flow-server/immersed/edge_strip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/prescribed_motion.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;
constexpr double h = 0.1;
/// Of a strip: half the ramp, its shift, and what goes on fully open.
constexpr double reach = (1 + 0.13 + 1.5) * h;
double width(const Point&) {
  return h;
}

struct Sheet {
  BodySurface surface;
  std::vector<FreeEdge> free_edge;
  std::vector<bool> attached;

  explicit Sheet(const surface::SurfaceMesh& mesh, std::span<const BorderPlane> planes = {})
      : surface(surface_of(mesh, false)) {
    free_edge = orient_surface(surface, FluidSide::outside, planes).free_edge;
    attached.assign(free_edge.size(), false);
  }
  EdgeStrip strip(double attached_length = 0) const {
    return EdgeStrip(surface, free_edge, attached, EdgeRamp{}, attached_length, width);
  }
};

Point corner_of(const BodySurface& surface, std::size_t triangle, std::size_t k) {
  return surface.position[static_cast<std::size_t>(surface.triangle[triangle][k])];
}
Point area_of(const BodySurface& surface, std::size_t triangle) {
  return area_vector(corner_of(surface, triangle, 0), corner_of(surface, triangle, 1), corner_of(surface, triangle, 2));
}

TEST(EdgeStrip, OpensLinearlyAcrossTheEnd) {
  const EdgeRamp ramp;
  EXPECT_DOUBLE_EQ(ramp.opening(-0.87 * h, h), 0);
  EXPECT_DOUBLE_EQ(ramp.opening(0.13 * h, h), 0.5);
  EXPECT_NEAR(ramp.opening(1.13 * h, h), 1, 1e-15);
  // On the strip beyond it goes on rising: by a half a cell.
  EXPECT_NEAR(ramp.opening(reach, h), 1.75, 1e-15);
  EXPECT_NEAR(ramp.beyond() * h, reach, 1e-15);
  EXPECT_EQ(ramp.opening(-5 * h, h), 0);
}

TEST(EdgeStrip, ProlongsASheetInTwoDimensionsAlongItself) {
  const std::vector<BorderPlane> planes = {{2, 0}, {2, 1}};
  const Sheet sheet(make_sheet_prism({{0, 0}, {3, 4}}, {}, 0.05), planes);
  ASSERT_EQ(sheet.free_edge.size(), 2u);
  const EdgeStrip strip = sheet.strip();
  const BodySurface& longer = strip.surface();
  EXPECT_EQ(longer.triangle.size(), sheet.surface.triangle.size() + 4);
  double area = 0;
  for (std::size_t t = 0; t < longer.triangle.size(); ++t) {
    area += length(area_of(longer, t));
    EXPECT_GT(dot(area_of(longer, t), area_of(longer, 0)), 0);  // all face the same way
  }
  EXPECT_NEAR(area, 5 + 2 * reach, 1e-12);
  for (std::size_t c = 0; c < longer.position.size(); ++c) {
    const double along = dot(longer.position[c], {0.6, 0.8, 0});
    const double beyond = std::max(-along, along - 5);  // of the nearer end
    EXPECT_NEAR(longer.opening[c], EdgeRamp{}.opening(beyond, h), 1e-12) << along;
    EXPECT_TRUE(longer.position[c][2] == 0 || longer.position[c][2] == 1);
  }
}

TEST(EdgeStrip, ShutsInProportionBeforeAnObstacle) {
  const std::vector<BorderPlane> planes = {{2, 0}, {2, 1}};
  const Sheet sheet(make_sheet_prism({{0, 0}, {0, 3}}, {}, 0.05), planes);
  EdgeStrip strip = sheet.strip();
  const BodySurface open = strip.surface();
  for (const double ajar : {1.5, 0.3, 0.0}) {
    // Above the upper end; the lower one has nothing before it.
    const auto clearance = [&](const Point&, const Point& direction) {
      EXPECT_NEAR(std::abs(direction[1]), 1, 1e-12);
      return direction[1] > 0 ? ajar * EdgeRamp{}.shut_from * h : 1e9;
    };
    strip.update(sheet.surface, width, clearance);
    const BodySurface& shut = strip.surface();
    EXPECT_EQ(shut.position, open.position);
    for (std::size_t c = 0; c < open.position.size(); ++c)
      EXPECT_NEAR(shut.opening[c], (open.position[c][1] > 1.5 ? std::min(ajar, 1.0) : 1) * open.opening[c], 1e-12);
  }
}

TEST(EdgeStrip, LeavesNoWedgeAtConvexCorners) {
  const Sheet sheet(make_rectangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, 0.08));
  const EdgeStrip strip = sheet.strip();
  const BodySurface& wider = strip.surface();
  double area = 0;
  for (std::size_t t = 0; t < wider.triangle.size(); ++t) {
    EXPECT_GT(area_of(wider, t)[2], 0);
    area += length(area_of(wider, t));
  }
  // Four quarters of an octagon's kind: four chords of 22.5 degrees each.
  const double fans = 16 * 0.5 * std::sin(pi / 8) * reach * reach;
  EXPECT_NEAR(area, 2 + 6 * reach + fans, 1e-12);
  for (std::size_t c = 0; c < wider.position.size(); ++c) {
    const Point& p = wider.position[c];
    const double dx = std::max(-p[0], p[0] - 2), dy = std::max(-p[1], p[1] - 1);
    const double beyond = dx > 0 && dy > 0 ? std::hypot(dx, dy) : std::max(dx, dy);
    EXPECT_NEAR(wider.opening[c], EdgeRamp{}.opening(beyond, h), 1e-12);
  }
}

TEST(EdgeStrip, StripsBeforeAConcaveCornerMeetMidwayWithoutOverlap) {
  // A plate without one quarter.
  BodySurface plate = surface_of(make_rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0.05 * std::numbers::sqrt2), false);
  std::erase_if(plate.triangle, [&](const std::array<int, 3>& t) {
    return std::all_of(t.begin(), t.end(), [&](int c) {
      const Point& p = plate.position[static_cast<std::size_t>(c)];
      return p[0] > -1e-9 && p[1] > -1e-9;
    });
  });
  const auto free_edge = orient_surface(plate, FluidSide::outside, {}).free_edge;
  const EdgeStrip strip(plate, free_edge, std::vector<bool>(free_edge.size(), false), EdgeRamp{}, 0, width);
  const BodySurface& wider = strip.surface();
  // Each place of the missing quarter within reach is covered once, with the opening of its distance from the nearer
  // edge.
  // Its rim is made of chords between corners half a cell apart, so not up to the reach itself.
  int n_places = 0;
  for (double x = 0.003; x < 0.4; x += 0.0107) {
    for (double y = 0.0041; y < 0.4; y += 0.0113) {
      if (std::abs(x - y) < 0.01 || std::min(x, y) > 0.88 * reach) continue;
      int n_covers = 0;
      double opening = 0;
      for (std::size_t t = 0; t < wider.triangle.size(); ++t) {
        const double area = area_of(wider, t)[2];
        std::array<double, 3> weight{};
        bool inside = area > 0;
        for (std::size_t k = 0; k < 3; ++k) {
          weight[k] =
              area_vector(corner_of(wider, t, (k + 1) % 3), corner_of(wider, t, (k + 2) % 3), {x, y, 0})[2] / area;
          inside = inside && weight[k] >= 0;
        }
        if (!inside) continue;
        ++n_covers;
        for (std::size_t k = 0; k < 3; ++k)
          opening += weight[k] * wider.opening[static_cast<std::size_t>(wider.triangle[t][k])];
      }
      ++n_places;
      EXPECT_EQ(n_covers, 1) << x << " " << y;
      EXPECT_NEAR(opening, EdgeRamp{}.opening(std::min(x, y), h), 1e-3) << x << " " << y;
    }
  }
  EXPECT_GT(n_places, 300);
  for (std::size_t t = 0; t < wider.triangle.size(); ++t) EXPECT_GT(area_of(wider, t)[2], 0);
}

TEST(EdgeStrip, FillsANarrowSlitOnceUpToItsMiddle) {
  // Two plates with a slit of half a cell between them, one surface.
  BodySurface plates = surface_of(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.07), false);
  const BodySurface right = surface_of(make_rectangle({1.05, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.07), false);
  const auto n = static_cast<int>(plates.position.size());
  plates.position.insert(plates.position.end(), right.position.begin(), right.position.end());
  plates.velocity.resize(plates.position.size());
  for (const auto& [a, b, c] : right.triangle) plates.triangle.push_back({a + n, b + n, c + n});
  const auto free_edge = orient_surface(plates, FluidSide::outside, {}).free_edge;
  const EdgeStrip strip(plates, free_edge, std::vector<bool>(free_edge.size(), false), EdgeRamp{}, 0, width);
  int n_in_slit = 0;
  for (std::size_t c = plates.position.size(); c < strip.surface().position.size(); ++c) {
    const Point& p = strip.surface().position[c];
    if (p[1] < 0.1 || p[1] > 0.9 || p[0] < 0.5 || p[0] > 1.5) continue;
    ++n_in_slit;
    EXPECT_NEAR(p[0], 1.025, 1e-6);
    EXPECT_NEAR(strip.surface().opening[c], EdgeRamp{}.opening(0.025, h), 1e-6);
  }
  EXPECT_GT(n_in_slit, 20);
}

TEST(EdgeStrip, AttachedEdgesGoOnBeyondTheWallWithTheOpeningBesideThem) {
  // Attached along x = 0 and along the ends of the free sides; free along y = 0, y = 1 and x = 2.
  Sheet sheet(make_rectangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, 0.08));
  for (std::size_t i = 0; i < sheet.free_edge.size(); ++i) {
    const FreeEdge& edge = sheet.free_edge[i];
    sheet.attached[i] = sheet.surface.position[static_cast<std::size_t>(edge.from)][0] == 0 &&
                        sheet.surface.position[static_cast<std::size_t>(edge.to)][0] == 0;
  }
  const EdgeStrip strip = sheet.strip(0.3);
  const BodySurface& wider = strip.surface();
  double area = 0, least_x = 0;
  for (std::size_t t = 0; t < wider.triangle.size(); ++t) {
    EXPECT_GT(area_of(wider, t)[2], 0);
    area += area_of(wider, t)[2];
  }
  for (std::size_t c = 0; c < wider.position.size(); ++c) {
    const Point& p = wider.position[c];
    least_x = std::min(least_x, p[0]);
    const double dx = p[0] - 2, dy = std::max(-p[1], p[1] - 1);
    const double beyond = dx > 0 && dy > 0 ? std::hypot(dx, dy) : std::max(dx, dy);
    EXPECT_NEAR(wider.opening[c], EdgeRamp{}.opening(beyond, h), 1e-12) << p[0] << " " << p[1];
  }
  const double fans = 8 * 0.5 * std::sin(pi / 8) * reach * reach;
  EXPECT_NEAR(area, 2.3 + (2 * 2.3 + 1) * reach + fans, 1e-12);
  EXPECT_NEAR(least_x, -0.3, 1e-14);
}

TEST(EdgeStrip, ASheetAcrossADuctFillsItsCornersBeyondTheWalls) {
  Sheet sheet(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.2));
  sheet.attached.assign(sheet.free_edge.size(), true);
  const EdgeStrip strip = sheet.strip(0.25);
  double area = 0;
  for (std::size_t t = 0; t < strip.surface().triangle.size(); ++t) area += area_of(strip.surface(), t)[2];
  EXPECT_NEAR(area, 1.5 * 1.5, 1e-12);
  EXPECT_EQ(*std::max_element(strip.surface().opening.begin(), strip.surface().opening.end()), 0);
}

/// A round, bent sheet that is partly attached, so that all kinds of corners occur.
Sheet bent_sheet() {
  Sheet sheet(make_rectangle({0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, 0.15));
  for (std::size_t i = 0; i < sheet.free_edge.size(); ++i) {
    const auto from = static_cast<std::size_t>(sheet.free_edge[i].from),
               to = static_cast<std::size_t>(sheet.free_edge[i].to);
    sheet.attached[i] = sheet.surface.position[from][1] < 1e-9 && sheet.surface.position[to][1] < 1e-9;
  }
  for (Point& p : sheet.surface.position) p[2] = 0.3 * std::sin(2 * p[0]) * (1 + p[1] * p[1]);
  return sheet;
}

TEST(EdgeStrip, VelocitiesAreTheRatesOfPositionsWhenTheSheetDeforms) {
  Sheet sheet = bent_sheet();
  EdgeStrip strip = sheet.strip(0.2);
  const std::vector<Point> at_rest = sheet.surface.position;
  const auto deform = [&](double t) {
    for (std::size_t i = 0; i < at_rest.size(); ++i) {
      const Point& p = at_rest[i];
      sheet.surface.position[i] = {p[0] + 0.1 * t * p[1], p[1] * (1 + 0.2 * t),
                                   p[2] + 0.5 * t * std::sin(3 * p[0]) * p[1]};
      sheet.surface.velocity[i] = {0.1 * p[1], 0.2 * p[1], 0.5 * std::sin(3 * p[0]) * p[1]};
    }
    strip.update(sheet.surface, width);
    return strip.surface();
  };
  constexpr double d = 1e-5;
  const BodySurface before = deform(0.3 - d), after = deform(0.3 + d), now = deform(0.3);
  for (std::size_t c = 0; c < now.position.size(); ++c) {
    const Point difference = (1 / (2 * d)) * (after.position[c] - before.position[c]);
    EXPECT_LT(distance(difference, now.velocity[c]), 1e-8) << c;  // d^2 x''' and round-off 1e-16 / d
  }
}

TEST(EdgeStrip, MovesRigidlyWithARigidSheet) {
  Sheet sheet = bent_sheet();
  EdgeStrip strip = sheet.strip(0.2);
  const std::vector<Point> at_rest = sheet.surface.position, wide_at_rest = strip.surface().position;
  const PrescribedMotion motion(
      {Translation{{FourierSeries{.frequency = 1, .cosine = {}, .sine = {1}}, 0.0, 0.5}},
       Rotation{{0.3, 0, 0}, {1, 2, 3}, FourierSeries{.frequency = 1, .cosine = {2}, .sine = {}}}});
  BodySurface expected;
  motion.move(at_rest, 0.2, sheet.surface);
  motion.move(wide_at_rest, 0.2, expected);
  strip.update(sheet.surface, width);
  for (std::size_t c = 0; c < wide_at_rest.size(); ++c) {
    EXPECT_LT(distance(strip.surface().position[c], expected.position[c]), 1e-12);
    EXPECT_LT(distance(strip.surface().velocity[c], expected.velocity[c]), 1e-11);  // speeds are about 10
  }
}

TEST(EdgeStrip, ForcesReachTheSheetWithSumAndWorkKept) {
  Sheet sheet = bent_sheet();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (Point& u : sheet.surface.velocity) u = {any(random), any(random), any(random)};
  EdgeStrip strip = sheet.strip(0.2);
  std::vector<Point> force(strip.surface().position.size());
  double power = 0;
  Point sum{};
  for (std::size_t c = 0; c < force.size(); ++c) {
    force[c] = {any(random), any(random), any(random)};
    power += dot(force[c], strip.surface().velocity[c]);
    sum = sum + force[c];
  }
  strip.gather(force);
  ASSERT_EQ(force.size(), sheet.surface.position.size());
  double sheet_power = 0;
  Point sheet_sum{};
  for (std::size_t c = 0; c < force.size(); ++c) {
    sheet_power += dot(force[c], sheet.surface.velocity[c]);
    sheet_sum = sheet_sum + force[c];
  }
  EXPECT_NEAR(sheet_power, power, 1e-12 * static_cast<double>(strip.surface().position.size()));
  EXPECT_LT(distance(sheet_sum, sum), 1e-12 * static_cast<double>(strip.surface().position.size()));
}

}  // namespace
}  // namespace couplet::flow
