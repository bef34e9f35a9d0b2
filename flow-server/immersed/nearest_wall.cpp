#include "flow-server/immersed/nearest_wall.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace couplet::flow {

namespace {

Eigen::Vector3d vector(const Point& point) {
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
  found_.clear(), bounds_.clear(), is_at_rest_.clear();
  for (const BodySurface& surface : surfaces) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Bounds bounds{Eigen::Array3d::Constant(infinite), Eigen::Array3d::Constant(-infinite)};
    for (const Point& point : surface.position) {
      bounds.low = bounds.low.min(vector(point).array());
      bounds.high = bounds.high.max(vector(point).array());
    }
    bounds_.push_back(bounds);
    is_at_rest_.push_back(std::all_of(surface.velocity.begin(), surface.velocity.end(),
                                      [](const Point& velocity) { return velocity == Point{}; }));
  }
}

ClosestPoint NearestWall::on(int surface, const Eigen::Vector3d& place, double largest_distance, NearbyWalls& nearby) {
  for (int f = nearby.last_closest; f > 0; f = found_[static_cast<std::size_t>(f - 1)].before) {
    const ClosestPoint& closest = found_[static_cast<std::size_t>(f - 1)].closest;
    if (closest.surface != surface) continue;
    return closest.distance <= largest_distance ? closest : ClosestPoint{};
  }
  const Bounds& bounds = bounds_[static_cast<std::size_t>(surface)];
  const Eigen::Array3d at = place.array();
  if (((bounds.low - at).max(at - bounds.high) > (1 + 1e-9) * largest_distance).any()) return {};
  int& hint = hint_[static_cast<std::size_t>(surface)];
  ClosestPoint closest =
      trees_[static_cast<std::size_t>(surface)].closest({place[0], place[1], place[2]}, largest_distance, hint);
  if (!closest.is_found()) return closest;
  closest.surface = surface, hint = closest.hint;
  found_.push_back({closest, nearby.last_closest});
  nearby.last_closest = static_cast<int>(found_.size());
  return closest;
}

ClosestPoint NearestWall::on_any(const Eigen::Vector3d& place, const Reach& reach_of, NearbyWalls& nearby) {
  constexpr double round_off = 1 + 1e-12;  // surfaces at the same distance are both found
  ClosestPoint nearest;
  for (const bool is_closed : {false, true})
    for (int s = 0; s < static_cast<int>(trees_.size()); ++s) {
      if (surface(s).is_closed != is_closed || !nearby.surfaces.contains(s)) continue;
      double reach = reach_of(surface(s));
      if (nearest.is_found()) reach = std::min(reach, nearest.distance * round_off);
      const ClosestPoint found = on(s, place, reach, nearby);
      if (!found.is_found()) continue;
      if (!nearest.is_found() || found.distance < nearest.distance ||
          (found.distance == nearest.distance && s < nearest.surface))
        nearest = found;
    }
  return nearest;
}

bool NearestWall::are_at_rest(const NearbyWalls& nearby) const {
  for (std::size_t s = 0; s < is_at_rest_.size(); ++s)
    if (!is_at_rest_[s] && nearby.surfaces.contains(static_cast<int>(s))) return false;
  return true;
}

Eigen::Vector3d NearestWall::normal(const ClosestPoint& at) const {
  const BodySurface& wall = surface(at.surface);
  const auto corner = [&](std::size_t v) {
    return vector(wall.position[static_cast<std::size_t>(corners(wall, at)[v])]);
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
