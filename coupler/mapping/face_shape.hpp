#pragma once
// Shape functions of the faces that a surface may have.

#include <array>

namespace couplet::coupling {

/// Values and derivatives at (a, b). Triangles: a, b >= 0, a + b <= 1; quadrilaterals: -1 <= a, b <= 1. Corners first,
/// then the midside nodes between corners 0-1, 1-2, ...
struct FaceShape {
  std::array<double, 8> value{}, along_a{}, along_b{};
};

/// n_nodes: 3, 4, 6 or 8.
FaceShape face_shape(int n_nodes, double a, double b);

inline bool is_triangle(int n_nodes) {
  return n_nodes == 3 || n_nodes == 6;
}

}  // namespace couplet::coupling
