#pragma once
// Simple surfaces to cut grids with.

#include <cmath>
#include <map>
#include <numbers>

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_surface.hpp"

namespace couplet::flow {

inline StretchedGrid uniform_box(const Triple& n_cells, double width, int n_dimensions = 3, bool is_periodic = false) {
  std::array<StretchedAxis, 3> axis{
      StretchedAxis(uniform_faces(0, n_cells[0] * width, n_cells[0]), is_periodic),
      StretchedAxis(uniform_faces(0, n_cells[1] * width, n_cells[1]), is_periodic),
      StretchedAxis(uniform_faces(0, n_cells[2] * width, n_cells[2]), is_periodic && n_dimensions == 3)};
  return {axis, n_dimensions};
}

/// An octahedron whose triangles are cut in four `n_cuts` times and whose corners are then put on a sphere.
inline BodySurface sphere_surface(const Point& centre, double radius, int n_cuts) {
  BodySurface surface;
  surface.name = "sphere";
  surface.is_closed = true;
  std::vector<Point> unit{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  surface.triangle = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int cut = 0; cut < n_cuts; ++cut) {
    std::map<std::array<int, 2>, int> middle;
    const auto middle_of = [&](int a, int b) {
      const auto [found, is_new] = middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(unit.size()));
      if (is_new) {
        Point point;
        double length = 0;
        for (std::size_t d = 0; d < 3; ++d) {
          point[d] = unit[static_cast<std::size_t>(a)][d] + unit[static_cast<std::size_t>(b)][d];
          length += point[d] * point[d];
        }
        for (double& x : point) x /= std::sqrt(length);
        unit.push_back(point);
      }
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : surface.triangle) {
      const int ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    surface.triangle = finer;
  }
  for (const Point& direction : unit)
    surface.position.push_back(
        {centre[0] + radius * direction[0], centre[1] + radius * direction[1], centre[2] + radius * direction[2]});
  surface.velocity.assign(surface.position.size(), {0, 0, 0});
  return surface;
}

/// A flat open sheet: the parallelogram at `corner` with the sides a and b, cut into n x n squares of two triangles.
inline BodySurface flat_sheet(const Point& corner, const Point& a, const Point& b, int n) {
  BodySurface surface;
  surface.name = "sheet";
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      Point point;
      for (std::size_t d = 0; d < 3; ++d) point[d] = corner[d] + (a[d] * i + b[d] * j) / n;
      surface.position.push_back(point);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int at = i + j * (n + 1);
      surface.triangle.push_back({at, at + 1, at + n + 2});
      surface.triangle.push_back({at, at + n + 2, at + n + 1});
    }
  surface.velocity.assign(surface.position.size(), {0, 0, 0});
  return surface;
}

/// The outline of a regular polygon in the plane z = 0, drawn out along z: a cylinder for two-dimensional flows.
inline BodySurface cylinder_surface(const Point& centre, double radius, int n_sides, double depth) {
  BodySurface surface;
  surface.name = "cylinder";
  surface.is_closed = true;
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < n_sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / n_sides;
      surface.position.push_back(
          {centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle), layer * depth});
    }
  for (int i = 0; i < n_sides; ++i) {
    const int next = (i + 1) % n_sides;
    surface.triangle.push_back({i, next, next + n_sides});
    surface.triangle.push_back({i, next + n_sides, i + n_sides});
  }
  surface.velocity.assign(surface.position.size(), {0, 0, 0});
  return surface;
}

}  // namespace couplet::flow
