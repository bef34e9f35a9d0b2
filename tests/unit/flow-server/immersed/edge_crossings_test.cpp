#include "flow-server/immersed/edge_crossings.hpp"

#include <gtest/gtest.h>

#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr int n = 16;
constexpr double h = 1.0 / n;

/// Against the distance from the surface, negative where it is solid. Triangles are flat: with sides a = 0.02 at most
/// they stand up to (a^2 / 3) / (2 R) = 3.3e-4 inside the smallest sphere; places nearer than that are left out.
template <class Distance>
void expect_inside(const EdgeCrossings& crossings, const Distance& distance) {
  constexpr double sagitta = 5e-4;
  int n_inside = 0, n_left_out = 0;
  const Box& cells = crossings.cells();
  for (int k = cells.begin[2]; k <= cells.end[2]; ++k)
    for (int j = cells.begin[1]; j <= cells.end[1]; ++j)
      for (int i = cells.begin[0]; i <= cells.end[0]; ++i) {
        const double away = distance(crossings.position({i, j, k}));
        if (std::abs(away) < sagitta) {
          ++n_left_out;
          continue;
        }
        EXPECT_EQ(crossings.is_inside({i, j, k}), away < 0) << i << " " << j << " " << k;
        n_inside += crossings.is_inside({i, j, k});
      }
  EXPECT_GT(n_inside, 0);
  EXPECT_LT(n_left_out, n_inside / 10);
}

/// A sphere seen from within.
BodySurface lumen(const Point& centre, double radius) {
  BodySurface surface = sphere_surface(centre, radius, 5);
  surface.is_lumen = true;
  for (auto& triangle : surface.triangle) std::swap(triangle[1], triangle[2]);
  return surface;
}

const Point middle{0.511, 0.493, 0.504};
double distance_from_middle(const Eigen::Vector3d& p) {
  return (p - Eigen::Vector3d(middle[0], middle[1], middle[2])).norm();
}

TEST(EdgeCrossings, ABodyInsideAnotherChangesNothingInside) {
  const StretchedGrid grid = uniform_box({n, n, n}, h);
  EdgeCrossings crossings(grid, box_of({n, n, n}), 0);
  const std::vector<BodySurface> bodies{sphere_surface(middle, 0.2, 4), sphere_surface(middle, 0.4, 5)};
  crossings.update(bodies);
  expect_inside(crossings, [](const Eigen::Vector3d& p) { return distance_from_middle(p) - 0.4; });
}

TEST(EdgeCrossings, OutsideALumenAllIsSolidAndABodyInItToo) {
  const StretchedGrid grid = uniform_box({n, n, n}, h);
  EdgeCrossings crossings(grid, box_of({n, n, n}), 0);
  const std::vector<BodySurface> bodies{lumen(middle, 0.42), sphere_surface(middle, 0.2, 4)};
  crossings.update(bodies);
  expect_inside(crossings, [](const Eigen::Vector3d& p) {
    return std::min(distance_from_middle(p) - 0.2, 0.42 - distance_from_middle(p));
  });
  crossings.update({});  // and nothing is left of them
  EXPECT_TRUE(crossings.crossed().empty());
  EXPECT_FALSE(crossings.is_inside({0, 0, 0}));
}

TEST(EdgeCrossings, APartOfTheGridSeesWhatTheWholeSees) {
  const StretchedGrid grid = uniform_box({n, n, n}, h);
  EdgeCrossings whole(grid, box_of({n, n, n}), 0), part(grid, {{9, 3, 2}, {n, 11, 12}}, 2);
  const std::vector<BodySurface> bodies{sphere_surface(middle, 0.4, 5)};
  whole.update(bodies), part.update(bodies);
  expect_inside(part, [](const Eigen::Vector3d& p) { return distance_from_middle(p) - 0.4; });
  int n_crossings = 0;
  for (const auto& [d, at] : part.crossed()) {
    const auto here = part.on_edge(d, at), there = whole.on_edge(d, {at[0] + 9, at[1] + 3, at[2] + 2});
    ASSERT_EQ(here.size(), there.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      EXPECT_EQ(here[c].share, there[c].share);
      EXPECT_EQ(here[c].triangle, there[c].triangle);
      ++n_crossings;
    }
  }
  EXPECT_GT(n_crossings, 100);
}

TEST(EdgeCrossings, StandWhereTheSurfaceIsWithItsVelocityAndOpening) {
  const StretchedGrid grid = uniform_box({n, n, n}, h);
  EdgeCrossings crossings(grid, box_of({n, n, n}), 0);
  // x + 0.3 y + 0.2 z = 0.8: a normal that points to larger x.
  std::vector<BodySurface> sheet{flat_sheet({1.3, -1, -1}, {-0.9, 3, 0}, {-0.6, 0, 3}, 7)};
  for (std::size_t c = 0; c < sheet[0].position.size(); ++c) {
    const Point& p = sheet[0].position[c];
    sheet[0].velocity[c] = {p[1], 2 * p[2], -p[0]};
    sheet[0].opening.push_back(std::max(0.0, p[1] * 1.6));
  }
  crossings.update(sheet);
  ASSERT_FALSE(crossings.crossed().empty());
  double largest_opening = 0;
  for (const auto& [d, corner] : crossings.crossed())
    for (const EdgeCrossing& crossing : crossings.on_edge(d, corner)) {
      Eigen::Vector3d at = crossings.position(corner);
      at[d] += crossing.share * h;
      EXPECT_NEAR(at.dot(Eigen::Vector3d(1, 0.3, 0.2)), 0.8, 1e-8);  // surfaces are moved by 1e-9 of a cell
      EXPECT_TRUE(crossing.leads_out);
      EXPECT_NEAR((crossing.velocity - Eigen::Vector3d(at[1], 2 * at[2], -at[0])).norm(), 0, 1e-8);
      // Cut off where it is read; between corners on both sides of y = 0 the ramp has its bend.
      if (at[1] > 3.0 / 7) {
        EXPECT_NEAR(crossing.opening, std::min(1.6 * at[1], 1.0), 1e-8);
      }
      largest_opening = std::max(largest_opening, crossing.opening);
    }
  EXPECT_EQ(largest_opening, 1);
}

TEST(EdgeCrossings, SeePeriodicImagesAtBothEnds) {
  const StretchedGrid grid = uniform_box({n, n, n}, h, 3, true);
  EdgeCrossings crossings(grid, box_of({n, n, n}), 1);
  const std::vector<BodySurface> bodies{sphere_surface({0.01, 0.98, 0.503}, 0.2, 4)};
  crossings.update(bodies);
  expect_inside(crossings, [](const Eigen::Vector3d& p) {
    const Eigen::Vector3d away = p - Eigen::Vector3d(0.01, 0.98, 0.503);
    return Eigen::Vector3d(away[0] - std::round(away[0]), away[1] - std::round(away[1]), away[2]).norm() - 0.2;
  });
}

TEST(EdgeCrossings, InTwoDimensionsAreTheSameAtBothEndsOfACell) {
  const StretchedGrid grid = uniform_box({n, n, 1}, h, 2);
  EdgeCrossings crossings(grid, box_of({n, n, 1}), 0);
  const std::vector<BodySurface> bodies{cylinder_surface({0.511, 0.493, 0}, 0.3, 400, h)};
  crossings.update(bodies);
  int n_crossings = 0;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double distance = std::hypot(i * h - 0.511, j * h - 0.493);
      EXPECT_EQ(crossings.is_inside({i, j, 0}), distance < 0.3);
      EXPECT_EQ(crossings.is_inside({i, j, 1}), distance < 0.3);
      EXPECT_TRUE(crossings.on_edge(2, {i, j, 0}).empty());
      for (int d = 0; d < 2; ++d) {
        const auto start = crossings.on_edge(d, {i, j, 0}), end = crossings.on_edge(d, {i, j, 1});
        ASSERT_EQ(start.size(), end.size());
        for (std::size_t c = 0; c < start.size(); ++c, ++n_crossings) EXPECT_EQ(&start[c], &end[c]);
      }
    }
  // A line of the grid within the circle crosses it twice: 0.6 / h of them in both directions, one more or less each.
  EXPECT_NEAR(n_crossings, 2 * 2 * 0.6 / h, 4);
}

}  // namespace
}  // namespace couplet::flow
