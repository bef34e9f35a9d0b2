#include "flow-server/immersed/edge_clearance.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {

namespace {

/// Cosine of the angle between the way on and a wall's normal, from which on the edge goes towards it, not along it.
constexpr double goes_towards = 0.2;

}  // namespace

double edge_clearance(const StretchedGrid& grid, std::span<const EdgeObstacle> obstacles, const Point& from,
                      const Point& direction, double reach) {
  double clearance = std::numeric_limits<double>::infinity();
  const auto meet = [&](double height, double towards) {
    if (towards > goes_towards) clearance = std::min(clearance, std::max(height / towards, 0.0));
  };
  for (std::size_t d = 0; d < static_cast<std::size_t>(grid.n_dimensions); ++d) {
    const StretchedAxis& axis = grid.axis[d];
    if (axis.is_periodic()) continue;
    meet(from[d] - axis.start(), -direction[d]);
    meet(axis.end() - from[d], direction[d]);
  }
  for (const EdgeObstacle& obstacle : obstacles) {
    const ClosestPoint closest = obstacle.tree->closest(from, reach);
    if (!closest.is_found()) continue;
    const auto& [a, b, c] = obstacle.surface->triangle[static_cast<std::size_t>(closest.triangle)];
    const std::vector<Point>& at = obstacle.surface->position;
    const Point area =
        area_vector(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)], at[static_cast<std::size_t>(c)]);
    const Point normal = (1 / length(area)) * area;  // into the fluid
    meet(dot(normal, from - closest.position), -dot(normal, direction));
  }
  return clearance < reach ? clearance : std::numeric_limits<double>::infinity();
}

}  // namespace couplet::flow
