#pragma once
// Gradients of the 20-node hexahedron at the 3 x 3 x 3 Gauss points, and their transpose, by its polynomial: some 250
// operations for one component at all points where the sum over nodes takes 1620.
//
// With the sets and coefficients of eight_point_gradient.hpp, T = H - B_x - B_y - B_z the trilinear part,
//   du/dx_k = A_1 + 2 x_k A_2,  A_2 = B_k,1 + B_k,i x_i + B_k,j x_j + B_k,ij x_i x_j,
//   A_1 = T_k + T_kj x_j + B_j,k x_j^2 + (T_ki + T_kij x_j + B_j,ki x_j^2) x_i + (B_i,k + B_i,kj x_j) x_i^2,
// where the points have x = -g, 0, g: A_1 and A_2 are found at nine places each, for three points each.

#include "solid-server/element/eight_point_gradient.hpp"

namespace couplet::solid::twenty_seven_points {

using eight_points::corner_node;
using eight_points::edge_node;
using eight_points::higher_other;
using eight_points::low_corner;
using eight_points::lower_other;
using eight_points::place;

constexpr double g_squared = 0.6, g = 0.77459666924148337704;  // sqrt(3/5)
constexpr int stride[3] = {1, 3, 9};                           // between points along an axis

/// The coefficients: T of each set, B of x_axis^2 with each set of the two other axes.
struct Coefficients {
  Pack T[8], B[3][4];
};

[[gnu::always_inline]] inline Coefficients coefficients(const Pack (&u)[hex20::n_nodes][3], int i) {
  Coefficients c;
  for (int corner = 0; corner < 8; ++corner) c.T[corner] = u[corner_node[corner]][i];
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      const int low = low_corner(axis, edge);
      c.B[axis][edge] = 0.125 * (c.T[low] + c.T[low + (1 << axis)]) - 0.25 * u[edge_node[axis][edge]][i];
    }
    eight_points::to_coefficients<2>(c.B[axis], 1);
  }
  eight_points::to_coefficients<3>(c.T, 1);
  for (int set = 1; set < 8; ++set) {
    c.T[set] *= 0.125;
    for (int axis = 0; axis < 3; ++axis)
      if (!(set & (1 << axis))) c.T[set] -= c.B[axis][place(axis, set)];
  }
  return c;
}

/// a + b x + c x^2 at x = -g, 0, g.
[[gnu::always_inline]] inline void on_line(const Pack& a, const Pack& b, const Pack& c, Pack (&value)[3]) {
  const Pack even = a + g_squared * c;
  value[0] = even - g * b;
  value[1] = a;
  value[2] = even + g * b;
}

/// Its transpose.
[[gnu::always_inline]] inline void from_line(const Pack (&value)[3], Pack& a, Pack& b, Pack& c) {
  const Pack ends = value[2] + value[0];
  a = ends + value[1];
  b = g * (value[2] - value[0]);
  c = g_squared * ends;
}

/// One component `i` of the nodal values u (20 nodes, 3) to its derivatives along xi, eta, zeta: slope[point][i][axis].
[[gnu::always_inline]] inline void gradient(const Pack (&u)[hex20::n_nodes][3], int i, Pack (&slope)[27][3][3]) {
  const auto [T, B] = coefficients(u, i);
  const Pack none{};
  for (int k = 0; k < 3; ++k) {
    const int a = lower_other(k), b = higher_other(k), K = 1 << k, A = 1 << a, C = 1 << b;
    Pack constant[3], linear[3], square[3], constant_2[3], linear_2[3];  // in x_a, at the three x_b
    on_line(T[K], T[K + C], B[b][place(b, K)], constant);
    on_line(T[K + A], T[7], B[b][place(b, K + A)], linear);
    on_line(B[a][place(a, K)], B[a][place(a, K + C)], none, square);
    on_line(B[k][0], B[k][place(k, C)], none, constant_2);
    on_line(B[k][place(k, A)], B[k][place(k, A + C)], none, linear_2);
    for (int r = 0; r < 3; ++r) {
      Pack A_1[3], A_2[3];
      on_line(constant[r], linear[r], square[r], A_1);
      on_line(constant_2[r], linear_2[r], none, A_2);
      for (int q = 0; q < 3; ++q) {
        const int point = q * stride[a] + r * stride[b];
        slope[point][i][k] = A_1[q] - 2 * g * A_2[q];
        slope[point + stride[k]][i][k] = A_1[q];
        slope[point + 2 * stride[k]][i][k] = A_1[q] + 2 * g * A_2[q];
      }
    }
  }
}

/// The transpose: flux[point][i][axis] to the component `i` of nodal forces f (20 nodes, 3).
[[gnu::always_inline]] inline void transposed_gradient(const Pack (&flux)[27][3][3], int i,
                                                       Pack (&f)[hex20::n_nodes][3]) {
  Pack T[8]{}, B[3][4]{}, none{};
  for (int k = 0; k < 3; ++k) {
    const int a = lower_other(k), b = higher_other(k), K = 1 << k, A = 1 << a, C = 1 << b;
    Pack constant[3], linear[3], square[3], constant_2[3], linear_2[3];
    for (int r = 0; r < 3; ++r) {
      Pack A_1[3], A_2[3];
      for (int q = 0; q < 3; ++q) {
        const int point = q * stride[a] + r * stride[b];
        const Pack low = flux[point][i][k], high = flux[point + 2 * stride[k]][i][k];
        A_1[q] = low + flux[point + stride[k]][i][k] + high;
        A_2[q] = 2 * g * (high - low);
      }
      from_line(A_1, constant[r], linear[r], square[r]);
      from_line(A_2, constant_2[r], linear_2[r], none);
    }
    const auto add = [&](const Pack(&values)[3], Pack& at_1, Pack& at_x, Pack& at_square) {
      Pack one, x, x_square;
      from_line(values, one, x, x_square);
      at_1 += one;
      at_x += x;
      at_square += x_square;
    };
    add(constant, T[K], T[K + C], B[b][place(b, K)]);
    add(linear, T[K + A], T[7], B[b][place(b, K + A)]);
    add(square, B[a][place(a, K)], B[a][place(a, K + C)], none);
    add(constant_2, B[k][0], B[k][place(k, C)], none);
    add(linear_2, B[k][place(k, A)], B[k][place(k, A + C)], none);
  }
  for (int set = 1; set < 8; ++set) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(set & (1 << axis))) B[axis][place(axis, set)] -= T[set];
    T[set] *= 0.125;
  }
  eight_points::to_values<3>(T, 1);
  for (int axis = 0; axis < 3; ++axis) {
    eight_points::to_values<2>(B[axis], 1);
    for (int edge = 0; edge < 4; ++edge) {
      const int low = low_corner(axis, edge);
      f[edge_node[axis][edge]][i] = -0.25 * B[axis][edge];
      T[low] += 0.125 * B[axis][edge];
      T[low + (1 << axis)] += 0.125 * B[axis][edge];
    }
  }
  for (int corner = 0; corner < 8; ++corner) f[corner_node[corner]][i] = T[corner];
}

}  // namespace couplet::solid::twenty_seven_points
