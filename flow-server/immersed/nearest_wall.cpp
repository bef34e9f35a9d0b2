#include "flow-server/immersed/nearest_wall.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace couplet::flow {

namespace {

Eigen::Vector3d corner(const BodySurface& surface, int triangle, std::size_t v) {
  return to_vector(surface.position[static_cast<std::size_t>(surface.triangle[static_cast<std::size_t>(triangle)][v])]);
}

}  // namespace

Eigen::Vector3d to_vector(const Point& point) {
  return {point[0], point[1], point[2]};
}

Eigen::Vector3d unit_normal(const BodySurface& surface, int triangle) {
  const Eigen::Vector3d a = corner(surface, triangle, 0);
  return (corner(surface, triangle, 1) - a).cross(corner(surface, triangle, 2) - a).normalized();
}

double velocity_at(const BodySurface& surface, const ClosestPoint& point, int component) {
  const auto& corners = surface.triangle[static_cast<std::size_t>(point.triangle)];
  double velocity = 0;
  for (std::size_t v = 0; v < 3; ++v)
    velocity +=
        point.weight[v] * surface.velocity[static_cast<std::size_t>(corners[v])][static_cast<std::size_t>(component)];
  return velocity;
}

double opening_at(const BodySurface& surface, const ClosestPoint& point) {
  if (surface.opening.empty()) return 0;
  const auto& corners = surface.triangle[static_cast<std::size_t>(point.triangle)];
  double opening = 0;
  for (std::size_t v = 0; v < 3; ++v)
    opening += point.weight[v] * surface.opening[static_cast<std::size_t>(corners[v])];
  return std::min(opening, 1.0);
}

void NearestWall::update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees) {
  surfaces_ = surfaces;
  trees_ = trees;
  hint_.assign(trees.size(), -1);
  bounds_.clear();
  for (const BodySurface& surface : surfaces) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Bounds bounds{Eigen::Array3d::Constant(infinite), Eigen::Array3d::Constant(-infinite)};
    for (const Point& point : surface.position) {
      bounds.low = bounds.low.min(to_vector(point).array());
      bounds.high = bounds.high.max(to_vector(point).array());
    }
    bounds_.push_back(bounds);
  }
}

ClosestPoint NearestWall::on(int surface, const Eigen::Vector3d& point, double largest_distance) {
  const Bounds& bounds = bounds_[static_cast<std::size_t>(surface)];
  const Eigen::Array3d at = point.array();
  if (((bounds.low - at).max(at - bounds.high) > (1 + 1e-9) * largest_distance).any()) return {};
  int& hint = hint_[static_cast<std::size_t>(surface)];
  ClosestPoint found =
      trees_[static_cast<std::size_t>(surface)].closest({point[0], point[1], point[2]}, largest_distance, hint);
  if (found.is_found()) found.surface = surface, hint = found.hint;
  return found;
}

ClosestPoint NearestWall::of_all(const Eigen::Vector3d& point, double largest_distance) {
  constexpr double round_off = 1 + 1e-12;  // surfaces at the same distance are both found
  ClosestPoint nearest;
  for (int s = 0; s < static_cast<int>(trees_.size()); ++s) {
    const ClosestPoint found = on(s, point, nearest.is_found() ? nearest.distance * round_off : largest_distance);
    if (!found.is_found() || opening_at(surfaces_[static_cast<std::size_t>(s)], found) >= 1) continue;
    if (!nearest.is_found() || found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

ClosestPoint NearestWall::that_counts(const Eigen::Vector3d& point, double reach_of_closed, double reach_of_sheets) {
  ClosestPoint first;
  double most = 0;
  for (int s = 0; s < static_cast<int>(trees_.size()); ++s) {
    const BodySurface& surface = surfaces_[static_cast<std::size_t>(s)];
    const double reach = surface.is_closed ? reach_of_closed : reach_of_sheets;
    const ClosestPoint found = on(s, point, reach);
    if (!found.is_found()) continue;
    const double counts = (1 - found.distance / reach) * (1 - opening_at(surface, found));
    if (counts > most) most = counts, first = found;
  }
  return first;
}

double NearestWall::gap(const Eigen::Vector3d& wall, const Eigen::Vector3d& away, double most) {
  constexpr double settled = 1 - 1e-3;  // balls that shrink by less than this touch the other wall
  constexpr int most_rounds = 8;
  constexpr double counts_from = 0.25;  // closed by more than this share, a wall bounds the gap as one without opening
  // Sine of half the angle under which the middle of the ball sees both points: a neighbouring triangle of the wall
  // itself, bent towards the ball, is touched beside its point, a wall on the other side across it.
  constexpr double beside = 0.5, across = 0.8;
  double radius = 0.5 * most;
  for (int round = 0; round < most_rounds; ++round) {
    const ClosestPoint other = of_all(wall + radius * away, settled * radius);
    if (!other.is_found()) break;
    const Eigen::Vector3d chord = to_vector(other.position) - wall;
    const double along = chord.dot(away);
    if (along <= 0) break;
    // The ball through the wall's point and the other one, with its middle on the normal.
    const double touching = std::min(0.5 * chord.squaredNorm() / along, radius);
    const double closed = 1 - opening_at(surfaces_[static_cast<std::size_t>(other.surface)], other);
    const double counts =
        std::min(closed / counts_from, 1.0) * std::clamp((along / chord.norm() - beside) / (across - beside), 0.0, 1.0);
    radius += counts * (touching - radius);
    if (counts < 1) break;
  }
  return 2 * radius;
}

}  // namespace couplet::flow
