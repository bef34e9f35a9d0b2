#pragma once
// What force and tangent of the stabilised hexahedron compute first, for eight elements.

#include "solid-server/element/eight_point_gradient.hpp"
#include "solid-server/element/packed_force.hpp"
#include "solid-server/element/stabilisation.hpp"

namespace couplet::solid::stabilisation {

/// Loads `n` numbers of the geometry.
template <int n>
[[gnu::always_inline]] inline void load_numbers(const StoredPack* stored, Pack (&values)[n]) {
  for (int k = 0; k < n; ++k) values[k] = load(stored[k]);
}

[[gnu::always_inline]] inline Pack dot(const Pack (&a)[3], const Pack (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The parts U_m of the modes in values at the nodes, without the constant one.
struct ModeParts {
  Pack at[n_modes][3];
};

[[gnu::always_inline]] inline ModeParts parts_of_modes(const NodePacks<8>& u) {
  ModeParts U;
  for (int i = 0; i < 3; ++i) {
    Pack corner[8];
    for (int c = 0; c < 8; ++c) corner[c] = u[eight_points::corner_node[c]][i];
    eight_points::to_coefficients<3>(corner, 1);  // eight times the parts
    for (int m = 0; m < n_modes; ++m) U.at[m][i] = 0.125 * corner[mode_axes[static_cast<std::size_t>(m)]];
  }
  return U;
}

/// The deformation of eight elements. Axis c stands for the plane of the two others, a = first_other, b = second_other.
struct Deformation {
  Pack B[n_modes][3], X[n_modes][3];
  Tensor<Pack> F;
  Pack d[3][3];  // d_j = Fbar g_j, (j, i)
  Pack q[4][3];  // hourglass amplitudes, (k, i)
  Pack a[4][3];  // a_kj = d_j . q_k

  /// From the displacement.
  [[gnu::always_inline]] inline Deformation(const StoredPack* geometry, const ModeParts& displacement) {
    const auto& U = displacement.at;
    for (int m = 0; m < n_modes; ++m) {
      load_numbers(geometry + gradient_at + 3 * m, B[m]);
      load_numbers(geometry + position_at + 3 * m, X[m]);
    }
    for (int i = 0; i < 3; ++i)
      for (int J = 0; J < 3; ++J) {
        F.at[i][J] = U[0][i] * B[0][J];
        for (int m = 1; m < n_modes; ++m) F.at[i][J] += U[m][i] * B[m][J];
      }
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i)
        q[k][i] = U[3 + k][i] - (F.at[i][0] * X[3 + k][0] + F.at[i][1] * X[3 + k][1] + F.at[i][2] * X[3 + k][2]);
    for (int i = 0; i < 3; ++i) F.at[i][i] += 1.0;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) d[j][i] = dot(F.at[i], X[j]);
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 3; ++j) a[k][j] = dot(q[k], d[j]);
  }
};

/// Stress resultants s = d(energy of stabilisation)/da, and that energy: a quadratic form of a.
struct Resultants {
  Pack s[4][3];
  Pack energy;

  [[gnu::always_inline]] inline Resultants(const Moduli& moduli, const StoredPack* geometry, const Pack (&a)[4][3]) {
    energy = Pack{};
    for (int j = 0; j < 3; ++j) {
      s[3][j] = moduli.young * load(geometry[highest_at + j]) * a[3][j];
      energy += 0.5 * s[3][j] * a[3][j];
      s[j][j] = Pack{};
    }
    const Pack third = load(geometry[volume_at]) * (1.0 / 3), twist = load(geometry[twist_at]);
    for (int c = 0; c < 3; ++c) {
      const int x = first_other(c), y = second_other(c);
      Pack A[3];
      load_numbers(geometry + frame_at + 3 * c, A);
      // Strain of unit directions A E A, per unit of xi_c.
      const Pack E_xx = a[y][x], E_yy = a[x][y], E_xy = 0.5 * (a[x][x] + a[y][y]);
      const Pack left_xx = A[0] * E_xx + A[1] * E_xy, left_xy = A[0] * E_xy + A[1] * E_yy;
      const Pack left_yx = A[1] * E_xx + A[2] * E_xy, left_yy = A[1] * E_xy + A[2] * E_yy;
      const Pack e_xx = left_xx * A[0] + left_xy * A[1], e_xy = left_xx * A[1] + left_xy * A[2];
      const Pack e_yy = left_yx * A[1] + left_yy * A[2];
      // Resultant of a plate, the integral of xi_c^2 being volume/3.
      const Pack trace = moduli.plate * (e_xx + e_yy);
      const Pack n_xx = third * (trace + 2 * moduli.shear * e_xx), n_yy = third * (trace + 2 * moduli.shear * e_yy);
      const Pack n_xy = third * (2 * moduli.shear) * twist * e_xy;
      energy += 0.5 * (n_xx * e_xx + n_yy * e_yy) + n_xy * e_xy;
      const Pack right_xx = A[0] * n_xx + A[1] * n_xy, right_xy = A[0] * n_xy + A[1] * n_yy;
      const Pack right_yx = A[1] * n_xx + A[2] * n_xy, right_yy = A[1] * n_xy + A[2] * n_yy;
      s[y][x] = right_xx * A[0] + right_xy * A[1];
      s[x][y] = right_yx * A[1] + right_yy * A[2];
      const Pack s_xy = right_xx * A[1] + right_xy * A[2];  // of 2 E_xy = a_xx + a_yy
      s[x][x] += s_xy;
      s[y][y] += s_xy;
    }
  }
};

}  // namespace couplet::solid::stabilisation
