#pragma once
// The eight-node quadrilateral.

#include <array>

namespace couplet::flow {

/// Shape functions of the serendipity quadrilateral at one point (r, s) in [-1, 1]^2 and their derivatives [ZTZ,
/// ch. 4]. Nodes: corners (-1,-1), (1,-1), (1,1), (-1,1), then the middles of edges 0-1, 1-2, 2-3, 3-0.
struct QuadraticFacePoint {
  std::array<double, 8> value;  // N_i
  std::array<double, 8> by_r;   // dN_i/dr
  std::array<double, 8> by_s;   // dN_i/ds
};

inline QuadraticFacePoint quadratic_face_point(double r, double s) {
  QuadraticFacePoint point{};
  constexpr std::array<double, 8> r_node{-1, 1, 1, -1, 0, 1, 0, -1};
  constexpr std::array<double, 8> s_node{-1, -1, 1, 1, -1, 0, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {  // N = 1/4 (1 + r r_i)(1 + s s_i)(r r_i + s s_i - 1)
    const double p = r * r_node[i], q = s * s_node[i];
    point.value[i] = 0.25 * (1 + p) * (1 + q) * (p + q - 1);
    point.by_r[i] = 0.25 * r_node[i] * (1 + q) * (2 * p + q);
    point.by_s[i] = 0.25 * s_node[i] * (1 + p) * (2 * q + p);
  }
  for (const std::size_t i : {4, 6}) {  // N = 1/2 (1 - r^2)(1 + s s_i)
    point.value[i] = 0.5 * (1 - r * r) * (1 + s * s_node[i]);
    point.by_r[i] = -r * (1 + s * s_node[i]);
    point.by_s[i] = 0.5 * (1 - r * r) * s_node[i];
  }
  for (const std::size_t i : {5, 7}) {  // N = 1/2 (1 + r r_i)(1 - s^2)
    point.value[i] = 0.5 * (1 + r * r_node[i]) * (1 - s * s);
    point.by_r[i] = 0.5 * r_node[i] * (1 - s * s);
    point.by_s[i] = -s * (1 + r * r_node[i]);
  }
  return point;
}

}  // namespace couplet::flow
