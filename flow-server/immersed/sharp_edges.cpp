#include "flow-server/immersed/sharp_edges.hpp"

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {

namespace {

/// Cosine of the angle by which the normal turns at a sharp edge: 45 degrees. A cylinder of nine flat sides is smooth.
constexpr double sharp_cosine = 0.7;

}  // namespace

std::vector<SharpEdge> find_sharp_edges(std::span<const Point> position, std::span<const std::array<int, 3>> triangle) {
  const auto corner = [&](int t, int v) {
    return position[static_cast<std::size_t>(triangle[static_cast<std::size_t>(t)][static_cast<std::size_t>(v)])];
  };
  const auto area_of = [&](int t) { return area_vector(corner(t, 0), corner(t, 1), corner(t, 2)); };
  struct Side {
    std::array<int, 2> corners;  // of the surface, the smaller number first
    int triangle;
    int first;  // corner of the triangle from which it runs to the next
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangle.size());
  for (std::size_t t = 0; t < triangle.size(); ++t)
    for (std::size_t v = 0; v < 3; ++v) {
      const auto [low, high] = std::minmax(triangle[t][v], triangle[t][(v + 1) % 3]);
      sides.push_back({{low, high}, static_cast<int>(t), static_cast<int>(v)});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.corners < b.corners; });
  std::vector<SharpEdge> sharp;
  for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
    const Side &one = sides[s], &other = sides[s + 1];
    if (one.corners != other.corners) continue;
    const Point area = area_of(one.triangle), next = area_of(other.triangle);
    if (dot(area, next) >= sharp_cosine * std::sqrt(dot(area, area) * dot(next, next))) continue;
    const Point opposite = corner(other.triangle, (other.first + 2) % 3);  // of the other triangle
    const bool is_convex = dot(area, opposite - corner(one.triangle, 0)) < 0;
    sharp.push_back({one.triangle, {one.first, (one.first + 1) % 3}, is_convex});
  }
  return sharp;
}

}  // namespace couplet::flow
