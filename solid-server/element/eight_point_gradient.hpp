#pragma once
// Gradients of the 20-node hexahedron at the 2 x 2 x 2 Gauss points, and their transpose, by butterflies: some 170
// operations for one component at all points where the sum over nodes takes 480.
//
// With signs x, y, z = +-1 of corners the shape space is {1, x, y, z, xy, yz, zx, xyz} and {1, y, z, yz} x^2 and so on.
// Along an edge in x the function is e + d x + b x^2 with b = (c+ + c-)/2 - e, so the coefficients B_x of x^2 {1, y, z,
// yz} are the Walsh-Hadamard transform of the four b; those of the corners' values c are H = T + B_x + B_y + B_z, T the
// trilinear part. At the points x^2 = y^2 = z^2 = g^2 = 1/3, hence along axis k, with the other two axes i and j,
//   d/dx_k = (H_k - 2/3 (B_i,k + B_j,k)) + (H_ki - 2/3 B_j,ki) x_i + (H_kj - 2/3 B_i,kj) x_j + H_xyz x_i x_j
//          + 2 x_k (B_k,1 + B_k,i x_i + B_k,j x_j + B_k,ij x_i x_j),
// which is again a transform, with g for each sign.

#include "solid-server/material/pack.hpp"
#include "solid-server/mesh/hex20_topology.hpp"

namespace couplet::solid::eight_points {

// A set of axes is a number: 1 for x, 2 for y, 4 for z. A corner is the set of axes along which it stands at +1; a
// point too.
constexpr int corner_node[8] = {0, 1, 3, 2, 4, 5, 7, 6};
// The edges along an axis, by the signs along the other two axes (the lower one counts 1, the higher one 2).
constexpr int edge_node[3][4] = {{8, 10, 12, 14}, {11, 9, 15, 13}, {16, 17, 19, 18}};

constexpr double g = 0.57735026918962576451;  // 1/sqrt(3)

/// The two other axes, rising.
constexpr int lower_other(int axis) {
  return axis == 0 ? 1 : 0;
}
constexpr int higher_other(int axis) {
  return axis == 2 ? 1 : 2;
}

/// Place of a set of axes among the coefficients of x_axis^2.
constexpr int place(int axis, int set) {
  return ((set >> lower_other(axis)) & 1) + 2 * ((set >> higher_other(axis)) & 1);
}

/// The corner where an edge begins.
constexpr int low_corner(int axis, int edge) {
  return ((edge & 1) << lower_other(axis)) + ((edge >> 1) << higher_other(axis));
}

/// v <- sum over corners (or points) of v times the product of the signs of a set, times a scale for each sign; for
/// each set.
template <int bits>
[[gnu::always_inline]] inline void to_coefficients(Pack (&v)[1 << bits], double scale) {
  for (int bit = 1; bit < (1 << bits); bit *= 2)
    for (int low = 0; low < (1 << bits); ++low)
      if (!(low & bit)) {
        const Pack sum = v[low + bit] + v[low], difference = scale * (v[low + bit] - v[low]);
        v[low] = sum;
        v[low + bit] = difference;
      }
}

/// Its transpose: from coefficients of sets to values at corners (or points).
template <int bits>
[[gnu::always_inline]] inline void to_values(Pack (&v)[1 << bits], double scale) {
  for (int bit = 1; bit < (1 << bits); bit *= 2)
    for (int low = 0; low < (1 << bits); ++low)
      if (!(low & bit)) {
        const Pack minus = v[low] - scale * v[low + bit], plus = v[low] + scale * v[low + bit];
        v[low] = minus;
        v[low + bit] = plus;
      }
}

/// One component `i` of the nodal values u (20 nodes, 3) to its derivatives along xi, eta, zeta: slope[point][i][axis].
[[gnu::always_inline]] inline void gradient(const Pack (&u)[hex20::n_nodes][3], int i, Pack (&slope)[8][3][3]) {
  Pack H[8], B[3][4];
  for (int corner = 0; corner < 8; ++corner) H[corner] = u[corner_node[corner]][i];
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      const int low = low_corner(axis, edge);
      B[axis][edge] = 0.5 * (H[low] + H[low + (1 << axis)]) - u[edge_node[axis][edge]][i];
    }
    to_coefficients<2>(B[axis], 1);  // four times the coefficients
  }
  to_coefficients<3>(H, 1);  // eight times the coefficients
  for (int k = 0; k < 3; ++k) {
    const int a = lower_other(k), b = higher_other(k), K = 1 << k, A = 1 << a, C = 1 << b;
    Pack v[8];
    v[0] = 0.125 * H[K] - (1.0 / 6) * (B[a][place(a, K)] + B[b][place(b, K)]);
    v[A] = 0.125 * H[K + A] - (1.0 / 6) * B[b][place(b, K + A)];
    v[C] = 0.125 * H[K + C] - (1.0 / 6) * B[a][place(a, K + C)];
    v[A + C] = 0.125 * H[7];
    for (const int set : {0, A, C, A + C}) v[K + set] = 0.5 * B[k][place(k, set)];
    to_values<3>(v, g);
    for (int point = 0; point < 8; ++point) slope[point][i][k] = v[point];
  }
}

/// The transpose: flux[point][i][axis] to the component `i` of nodal forces f (20 nodes, 3).
[[gnu::always_inline]] inline void transposed_gradient(const Pack (&flux)[8][3][3], int i,
                                                       Pack (&f)[hex20::n_nodes][3]) {
  Pack H[8]{}, B[3][4]{};
  for (int k = 0; k < 3; ++k) {
    const int a = lower_other(k), b = higher_other(k), K = 1 << k, A = 1 << a, C = 1 << b;
    Pack v[8];
    for (int point = 0; point < 8; ++point) v[point] = flux[point][i][k];
    to_coefficients<3>(v, g);
    H[K] += 0.125 * v[0];
    H[K + A] += 0.125 * v[A];
    H[K + C] += 0.125 * v[C];
    H[7] += 0.125 * v[A + C];
    B[a][place(a, K)] -= (1.0 / 6) * v[0];
    B[b][place(b, K)] -= (1.0 / 6) * v[0];
    B[b][place(b, K + A)] -= (1.0 / 6) * v[A];
    B[a][place(a, K + C)] -= (1.0 / 6) * v[C];
    for (const int set : {0, A, C, A + C}) B[k][place(k, set)] += 0.5 * v[K + set];
  }
  to_values<3>(H, 1);
  for (int axis = 0; axis < 3; ++axis) {
    to_values<2>(B[axis], 1);
    for (int edge = 0; edge < 4; ++edge) {
      const int low = low_corner(axis, edge);
      f[edge_node[axis][edge]][i] = -B[axis][edge];
      H[low] += 0.5 * B[axis][edge];
      H[low + (1 << axis)] += 0.5 * B[axis][edge];
    }
  }
  for (int corner = 0; corner < 8; ++corner) f[corner_node[corner]][i] = H[corner];
}

}  // namespace couplet::solid::eight_points
