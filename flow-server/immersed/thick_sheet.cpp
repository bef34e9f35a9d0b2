#include "flow-server/immersed/thick_sheet.hpp"

#include <cassert>
#include <cmath>

#include "flow-server/immersed/moving_point.hpp"

namespace couplet::flow {

namespace {

Point times(const Point& a, const Point& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}

}  // namespace

ThickSheet::ThickSheet(const BodySurface& sheet, const SurfaceTopology& topology, double thickness)
    : half_thickness_(thickness / 2), sheet_triangle_(sheet.triangle) {
  assert(thickness > 0);
  const auto n = static_cast<int>(sheet.position.size());
  surface_.name = sheet.name;
  surface_.is_closed = true;
  surface_.blend_width = sheet.blend_width;
  surface_.triangle = sheet.triangle;
  for (const auto& [a, b, c] : sheet.triangle) surface_.triangle.push_back({a + n, c + n, b + n});
  for (const FreeEdge& edge : topology.free_edge) {
    surface_.triangle.push_back({edge.to, edge.from, edge.from + n});
    surface_.triangle.push_back({edge.to, edge.from + n, edge.to + n});
  }
  is_free_.assign(sheet.position.size(), {1, 1, 1});
  for (const FreeEdge& edge : topology.border_edge) {
    const Point &from = sheet.position[static_cast<std::size_t>(edge.from)],
                &to = sheet.position[static_cast<std::size_t>(edge.to)];
    // The plane that both ends lie on, but for round-off: the nearest one.
    const BorderPlane* plane = nullptr;
    double nearest = 0;
    for (const BorderPlane& candidate : topology.border_plane) {
      const auto d = static_cast<std::size_t>(candidate.axis);
      const double away = std::abs(from[d] - candidate.position) + std::abs(to[d] - candidate.position);
      if (!plane || away < nearest) plane = &candidate, nearest = away;
    }
    if (!plane) continue;
    for (const int corner : {edge.from, edge.to})
      is_free_[static_cast<std::size_t>(corner)][static_cast<std::size_t>(plane->axis)] = 0;
  }
  update(sheet);
}

void ThickSheet::update(const BodySurface& sheet) {
  const std::size_t n = is_free_.size();
  assert(sheet.position.size() == n);
  std::vector<MovingPoint> normal(n, MovingPoint{});
  for (const auto& corners : sheet_triangle_) {
    std::array<MovingPoint, 3> at;
    for (std::size_t v = 0; v < 3; ++v) {
      const auto c = static_cast<std::size_t>(corners[v]);
      at[v] = {sheet.position[c], sheet.velocity[c]};
    }
    const MovingPoint area = 0.5 * cross(at[1] - at[0], at[2] - at[0]);
    for (const int corner : corners) {
      MovingPoint& sum = normal[static_cast<std::size_t>(corner)];
      sum = sum + area;
    }
  }
  sheet_position_ = sheet.position;
  normal_.resize(n);
  surface_.position.resize(2 * n);
  surface_.velocity.resize(2 * n);
  for (std::size_t c = 0; c < n; ++c) {
    const MovingPoint along{times(is_free_[c], normal[c].x), times(is_free_[c], normal[c].u)};
    normal_[c] = along.x;
    const MovingPoint middle{sheet.position[c], sheet.velocity[c]}, half = half_thickness_ * unit(along);
    const MovingPoint front = middle + half, back = middle - half;
    surface_.position[c] = front.x, surface_.velocity[c] = front.u;
    surface_.position[n + c] = back.x, surface_.velocity[n + c] = back.u;
  }
}

void ThickSheet::gather(std::vector<Point>& force) const {
  const std::size_t n = is_free_.size();
  assert(force.size() == 2 * n);
  // u_front - u_back = t d(unit N), d(unit N) = (I - n n^T) dN / |N|, dN: sum of half of d((b - a) x (c - a)).
  std::vector<Point> on_normal(n);  // what does work with dN
  for (std::size_t c = 0; c < n; ++c) {
    const Point couple = half_thickness_ * (force[c] - force[n + c]);
    const double size = length(normal_[c]);
    const Point direction = (1 / size) * normal_[c];
    on_normal[c] = times(is_free_[c], (1 / size) * (couple - dot(couple, direction) * direction));
    force[c] = force[c] + force[n + c];
  }
  force.resize(n);
  for (const auto& corners : sheet_triangle_) {
    const auto a = static_cast<std::size_t>(corners[0]), b = static_cast<std::size_t>(corners[1]),
               c = static_cast<std::size_t>(corners[2]);
    const Point sum = 0.5 * (on_normal[a] + on_normal[b] + on_normal[c]);
    const Point at_b = cross(sheet_position_[c] - sheet_position_[a], sum);
    const Point at_c = cross(sum, sheet_position_[b] - sheet_position_[a]);
    force[b] = force[b] + at_b;
    force[c] = force[c] + at_c;
    force[a] = force[a] - (at_b + at_c);
  }
}

}  // namespace couplet::flow
