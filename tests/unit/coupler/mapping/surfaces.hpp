#pragma once
// Surfaces that the tests of the mapping share.

#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

using Shape = std::function<Eigen::Vector3d(double, double)>;  // position over the unit square

/// n_a x n_b faces over the unit square with 3, 4, 6 or 8 nodes each; midside nodes lie on the shape itself.
inline surface::SurfaceMesh make_surface(int nodes_per_face, int n_a, int n_b, const Shape& shape) {
  surface::SurfaceMesh mesh;
  std::map<std::pair<int, int>, std::int64_t> node_at;  // half-cell lattice
  std::vector<Eigen::Vector3d> position;
  const auto node = [&](int i, int j) {
    const auto [found, is_new] = node_at.try_emplace({i, j}, static_cast<std::int64_t>(position.size()));
    if (is_new) position.push_back(shape(0.5 * i / n_a, 0.5 * j / n_b));
    return found->second;
  };
  std::vector<std::int64_t> face_node, face_offset{0};
  const auto add_face = [&](std::initializer_list<std::pair<int, int>> lattice) {
    for (const auto& [i, j] : lattice) face_node.push_back(node(i, j));
    face_offset.push_back(static_cast<std::int64_t>(face_node.size()));
  };
  for (int a = 0; a < 2 * n_a; a += 2) {
    for (int b = 0; b < 2 * n_b; b += 2) {
      const int c = a + 1, d = b + 1, e = a + 2, f = b + 2;
      if (nodes_per_face == 4) add_face({{a, b}, {e, b}, {e, f}, {a, f}});
      if (nodes_per_face == 8) add_face({{a, b}, {e, b}, {e, f}, {a, f}, {c, b}, {e, d}, {c, f}, {a, d}});
      if (nodes_per_face == 3) {
        add_face({{a, b}, {e, b}, {e, f}});
        add_face({{a, b}, {e, f}, {a, f}});
      }
      if (nodes_per_face == 6) {
        add_face({{a, b}, {e, b}, {e, f}, {c, b}, {e, d}, {c, d}});
        add_face({{a, b}, {e, f}, {a, f}, {c, d}, {c, f}, {a, d}});
      }
    }
  }
  mesh.node_position.resize(static_cast<Eigen::Index>(position.size()), 3);
  for (std::size_t k = 0; k < position.size(); ++k) mesh.node_position.row(k) = position[k].transpose();
  mesh.face_node = Eigen::Map<surface::IndexArray>(face_node.data(), static_cast<Eigen::Index>(face_node.size()));
  mesh.face_offset = Eigen::Map<surface::IndexArray>(face_offset.data(), static_cast<Eigen::Index>(face_offset.size()));
  mesh.face_region = surface::IndexArray::Zero(mesh.n_faces());
  mesh.region = {"wall"};
  return mesh;
}

/// A skewed parallelogram in space.
inline Eigen::Vector3d plane(double a, double b) {
  return {0.02 * a + 0.003 * b, 0.01 + 0.004 * a, 0.015 * b};
}

/// A quarter of a cylinder of radius 1 cm along z, away from the origin.
inline Eigen::Vector3d cylinder(double a, double b) {
  const double angle = 1.5 * a;
  return {0.05 + 0.01 * std::cos(angle), 0.01 * std::sin(angle), 0.02 * b};
}

}  // namespace couplet::coupling
