#pragma once
// Surfaces of folds for tests: an outline in the plane of the flow, extruded along z.

#include <cmath>
#include <functional>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

struct ExtrudedFold {
  std::function<Eigen::Vector2d(double t)>
      outline;           // (x, y) [m] from the upstream end (t = 0) to the downstream end (t = 1)
  int n_across = 16;     // faces along the outline
  int n_rows = 6;        // faces along z
  double z_low = 0;      // [m]
  double z_high = 0.01;  // [m]
};

/// Number of the node at half-face position (i along the outline, j along z); the middle of a face has none.
inline std::int64_t node_number(const ExtrudedFold& fold, int i, int j) {
  const std::int64_t on_full_line = 2 * fold.n_across + 1, on_half_line = fold.n_across + 1;
  const std::int64_t before = (j / 2) * (on_full_line + on_half_line) + (j % 2) * on_full_line;
  return before + (j % 2 == 0 ? i : i / 2);
}

/// Eight-node faces whose normals point up (+y side), into the flow.
inline surface::SurfaceMesh make_surface(const ExtrudedFold& fold) {
  surface::SurfaceMesh mesh;
  const int ni = 2 * fold.n_across, nj = 2 * fold.n_rows;
  mesh.node_position.resize(node_number(fold, ni, nj) + 1, 3);
  for (int j = 0; j <= nj; ++j) {
    for (int i = 0; i <= ni; i += 1 + j % 2) {
      const Eigen::Vector2d point = fold.outline(static_cast<double>(i) / ni);
      const double z = fold.z_low + (fold.z_high - fold.z_low) * j / nj;
      mesh.node_position.row(node_number(fold, i, j)) << point[0], point[1], z;
    }
  }
  const std::int64_t n_faces = static_cast<std::int64_t>(fold.n_across) * fold.n_rows;
  mesh.face_offset = surface::IndexArray::LinSpaced(n_faces + 1, 0, 8 * n_faces);
  mesh.face_region.setZero(n_faces);
  mesh.region = {"wetted"};
  mesh.face_node.resize(8 * n_faces);
  std::int64_t at = 0;
  for (int row = 0; row < nj; row += 2) {
    for (int i = 0; i < ni; i += 2) {
      // r runs along +z, s along +x: z cross x = y, out of the fold
      const std::array<std::array<int, 2>, 8> place{{{0, 0}, {0, 2}, {2, 2}, {2, 0}, {0, 1}, {1, 2}, {2, 1}, {1, 0}}};
      for (const auto& [di, dj] : place) mesh.face_node[at++] = node_number(fold, i + di, row + dj);
    }
  }
  return mesh;
}

/// A fold of 13 mm along the flow and 10 mm depth: a rise, a nearly flat top from about 10 to 12 mm, a steep downstream
/// face.
inline Eigen::Vector2d fold_outline(double t) {
  const double depth = 0.01;
  const double s = 2.4 * t;  // 0 .. 1 rise, 1 .. 1.4 top, 1.4 .. 2.4 fall
  if (s < 1) return {0.010 * s, depth * std::sin(0.5 * 3.14159265358979324 * s)};
  if (s < 1.4) return {0.010 + 0.002 * (s - 1) / 0.4, depth};
  return {0.012 + 0.001 * (s - 1.4), depth * (1 - (s - 1.4) * (s - 1.4))};
}

}  // namespace couplet::flow
