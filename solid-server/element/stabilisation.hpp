#pragma once
// The stabilised 8-node hexahedron: one mean deformation gradient, and an energy for the ways to deform that it does
// not see.
//
// Nodal values are a sum of 1, xi, eta, zeta and of the hourglass functions h_0 = eta zeta, h_1 = zeta xi, h_2 = xi
// eta, h_3 = xi eta zeta. With the mean gradients B of these functions over the element [Flanagan, Belytschko 1981] the
// deformation gradient is Fbar = I + sum of U_m (x) B_m, which is exact for every linear field, and the amplitudes
//   q_k = U_hk - (Fbar - I) X_hk,   U_m and X_m the parts of mode m in the displacement and in the position at rest,
// vanish for every linear field: the element passes the patch test whatever its shape.
//
// To first order in q the Green strain of x = Fbar X + sum of q_k h_k is sym(qhat_k (x) grad h_k), qhat = Fbar^T q,
// which does not see rotations. Its components along the element's directions g_j = dX/dxi_j at rest are, with a_kj =
// g_j . qhat_k,
//   E_jj = sum of a_kj dh_k/dxi_j,   2 E_ij = sum of a_ki dh_k/dxi_j + a_kj dh_k/dxi_i.
// Kept are, for each axis c and the other two a and b, the strains in the plane of g_a, g_b that are linear in xi_c:
//   E_aa = a_ba xi_c,  E_bb = a_ab xi_c,  2 E_ab = (a_aa + a_bb) xi_c,
// bending and twisting of a plate with normal g_a x g_b, with the stress of a plate (none on the normal): so thin
// elements bend and nearly incompressible ones keep their volume without locking [Belytschko, Bindeman 1993, Puso 2000:
// the same amplitudes, with other moduli]. Shear strains that come with bending (a_ba in 2 E_ac, linear in xi_a) are
// left out: they are what locks. The amplitudes a_3j get Young's modulus. Moduli are those at rest, so that the energy
// is a polynomial of the displacement.
//
// A linear twist makes a bar of rectangular section too stiff, by 18 % for a square, for it cannot warp. The modulus of
// E_ab is scaled by the exact torsional stiffness [Timoshenko, Goodier 1970, 109] over that of the linear twist, for
// the section of the two shorter sides; thin plates keep mu.

#include <array>

#include "solid-server/element/deformation.hpp"

namespace couplet::solid::stabilisation {

constexpr int n_modes = 7;  // xi, eta, zeta, h_0, h_1, h_2, h_3

/// The mode as a set of axes, 1 for xi, 2 for eta, 4 for zeta.
constexpr std::array<int, n_modes> mode_axes = {1, 2, 4, 6, 5, 3, 7};

// Where what an element needs stands in its geometry.
constexpr int gradient_at = 0;   // B_m [1/m], (n_modes, 3)
constexpr int position_at = 21;  // X_m [m], (n_modes, 3); g_j is X_j
constexpr int frame_at = 42;   // for each axis c: A_aa, A_ab, A_bb [1/m], A^-2 the products of g_a, g_b; strain of unit
                               // directions = A E A
constexpr int volume_at = 51;  // [m^3]
constexpr int twist_at = 52;   // factor of the modulus of E_ab [1]
constexpr int highest_at = 53;  // volume/9 |g_j|^-4, of a_3j [1/m], (3)
constexpr int n_geometry = 56;

std::array<double, n_geometry> geometry(const ElementVectors& position);

/// Moduli of small strain without fibres [Pa].
struct Moduli {
  double plate;  // E nu/(1 - nu^2): of the trace of the strains of a plate
  double shear;  // mu
  double young;  // E
};

/// From the shear modulus mu and the bulk modulus K.
constexpr Moduli moduli(double mu, double K) {
  const double lambda = K - 2.0 / 3 * mu;
  return {2 * mu * lambda / (lambda + 2 * mu), mu, 9 * K * mu / (3 * K + mu)};
}

/// The other two axes, in turn.
constexpr int first_other(int axis) {
  return (axis + 1) % 3;
}
constexpr int second_other(int axis) {
  return (axis + 2) % 3;
}

}  // namespace couplet::solid::stabilisation
