#include "flow-server/immersed/nearest_wall.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace couplet::flow {

namespace {

Eigen::Vector3d vector_of(const Point& point) {
  return {point[0], point[1], point[2]};
}

const std::array<int, 3>& corners(const BodySurface& surface, const ClosestPoint& at) {
  return surface.triangle[static_cast<std::size_t>(at.triangle)];
}

}  // namespace

void NearestWall::update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees) {
  surfaces_ = surfaces;
  trees_ = trees;
  hint_.assign(trees.size(), -1);
  hint_across_.assign(trees.size(), -1);
  found_.clear(), bounds_.clear(), is_at_rest_.clear();
  for (const BodySurface& surface : surfaces) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Bounds bounds{Eigen::Array3d::Constant(infinite), Eigen::Array3d::Constant(-infinite)};
    for (const Point& point : surface.position) {
      bounds.low = bounds.low.min(vector_of(point).array());
      bounds.high = bounds.high.max(vector_of(point).array());
    }
    bounds_.push_back(bounds);
    is_at_rest_.push_back(std::all_of(surface.velocity.begin(), surface.velocity.end(),
                                      [](const Point& velocity) { return velocity == Point{}; }));
  }
}

ClosestPoint NearestWall::find(int surface, const Eigen::Vector3d& place, double largest_distance, int& hint) const {
  const Bounds& bounds = bounds_[static_cast<std::size_t>(surface)];
  const Eigen::Array3d at = place.array();
  if (((bounds.low - at).max(at - bounds.high) > (1 + 1e-9) * largest_distance).any()) return {};
  ClosestPoint closest =
      trees_[static_cast<std::size_t>(surface)].closest({place[0], place[1], place[2]}, largest_distance, hint);
  if (closest.is_found()) closest.surface = surface, hint = closest.hint;
  return closest;
}

ClosestPoint NearestWall::on(int surface, const Eigen::Vector3d& place, double largest_distance, NearbyWalls& nearby) {
  for (int f = nearby.last_closest; f > 0; f = found_[static_cast<std::size_t>(f - 1)].before) {
    const ClosestPoint& closest = found_[static_cast<std::size_t>(f - 1)].closest;
    if (closest.surface != surface) continue;
    return closest.distance <= largest_distance ? closest : ClosestPoint{};
  }
  const ClosestPoint closest = find(surface, place, largest_distance, hint_[static_cast<std::size_t>(surface)]);
  if (!closest.is_found()) return closest;
  found_.push_back({closest, nearby.last_closest});
  nearby.last_closest = static_cast<int>(found_.size());
  return closest;
}

ClosestPoint NearestWall::that_counts(const Eigen::Vector3d& place, const Reach& reach_of, NearbyWalls& nearby) {
  ClosestPoint first;
  double most = 0;
  for (int s = 0; s < static_cast<int>(trees_.size()); ++s) {
    if (!nearby.surfaces.contains(s)) continue;
    const double reach = reach_of(surface(s));
    const ClosestPoint found = on(s, place, (1 - most) * reach, nearby);  // farther away it counts less
    if (!found.is_found()) continue;
    const double counts = (1 - found.distance / reach) * (1 - opening(found));
    if (counts > most) most = counts, first = found;
  }
  return first;
}

ClosestPoint NearestWall::of_all(const Eigen::Vector3d& place, double largest_distance) {
  constexpr double round_off = 1 + 1e-12;  // surfaces at the same distance are both found
  ClosestPoint nearest;
  for (int s = 0; s < static_cast<int>(trees_.size()); ++s) {
    const ClosestPoint found = find(s, place, nearest.is_found() ? nearest.distance * round_off : largest_distance,
                                    hint_across_[static_cast<std::size_t>(s)]);
    if (!found.is_found() || opening(found) >= 1) continue;
    if (!nearest.is_found() || found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

double NearestWall::gap(const ClosestPoint& at, const Eigen::Vector3d& away, double most) {
  constexpr double settled = 1 - 1e-3;  // balls that shrink by less than this touch the other wall
  constexpr int most_rounds = 8;
  constexpr double counts_from = 0.25;  // closed by more than this share, a wall bounds the gap as one without opening
  // Sine of half the angle under which the middle of the ball sees both points: a neighbouring triangle of the wall
  // itself, bent towards the ball, is touched beside its point, a wall on the other side across it.
  constexpr double beside = 0.5, across = 0.8;
  const Eigen::Vector3d wall = vector_of(at.position);
  double radius = 0.5 * most;
  for (int round = 0; round < most_rounds; ++round) {
    const ClosestPoint other = of_all(wall + radius * away, settled * radius);
    if (!other.is_found()) break;
    const Eigen::Vector3d chord = vector_of(other.position) - wall;
    const double along = chord.dot(away);
    if (along <= 0) break;
    // The ball through the wall's point and the other one, with its middle on the normal.
    const double touching = std::min(0.5 * chord.squaredNorm() / along, radius);
    const double counts = std::min((1 - opening(other)) / counts_from, 1.0) *
                          std::clamp((along / chord.norm() - beside) / (across - beside), 0.0, 1.0);
    radius += counts * (touching - radius);
    if (counts < 1) break;
  }
  return 2 * radius;
}

bool NearestWall::is_empty(const ClosestPoint& wall, const Eigen::Vector3d& to_middle, double radius) {
  return !of_all(vector_of(wall.position) + to_middle, radius).is_found();
}

bool NearestWall::are_at_rest(const NearbyWalls& nearby) const {
  for (std::size_t s = 0; s < is_at_rest_.size(); ++s)
    if (!is_at_rest_[s] && nearby.surfaces.contains(static_cast<int>(s))) return false;
  return true;
}

Eigen::Vector3d NearestWall::normal(const ClosestPoint& at) const {
  const BodySurface& wall = surface(at.surface);
  const auto corner = [&](std::size_t v) {
    return vector_of(wall.position[static_cast<std::size_t>(corners(wall, at)[v])]);
  };
  const Eigen::Vector3d a = corner(0);
  return (corner(1) - a).cross(corner(2) - a).normalized();
}

double NearestWall::velocity(const ClosestPoint& at, int component) const {
  if (is_at_rest_[static_cast<std::size_t>(at.surface)]) return 0;
  const BodySurface& wall = surface(at.surface);
  double velocity = 0;
  for (std::size_t v = 0; v < 3; ++v)
    velocity += at.weight[v] *
                wall.velocity[static_cast<std::size_t>(corners(wall, at)[v])][static_cast<std::size_t>(component)];
  return velocity;
}

double NearestWall::opening(const ClosestPoint& at) const {
  const BodySurface& wall = surface(at.surface);
  if (wall.opening.empty()) return 0;
  double opening = 0;
  for (std::size_t v = 0; v < 3; ++v)
    opening += at.weight[v] * wall.opening[static_cast<std::size_t>(corners(wall, at)[v])];
  return std::min(opening, 1.0);
}

}  // namespace couplet::flow
