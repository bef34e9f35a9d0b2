#pragma once
// The tangent of eight elements at once.

#include "solid-server/element/element_packs.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

/// Pairs (a, b) of local nodes with a >= b, b rising, then a.
constexpr Index n_local_pairs(int n_nodes) {
  return n_nodes * (n_nodes + 1) / 2;
}
constexpr Index local_pair(int n_nodes, int a, int b) {
  return b * n_nodes - b * (b - 1) / 2 + a - b;
}

/// For the packs [first, last): the second derivative of the strain energy by the displacement,
///   K_(a i)(b k) = sum over points of dN_a/dX_J (d2W/dF_iJ dF_kL) dN_b/dX_L dV [N/m]
///   [Belytschko, Liu, Moran 2000, 6.4], material and geometric stiffness in one,
/// into `blocks`, (packs, local pairs, 3 i + k). `displacement` is a NodeVectors array [m].
///
/// `increment` d, a NodeVectors array [m], or null: with it the geometric stiffness takes the stress that is linear
/// along the step d, and the stiffness of the volume the pressure that is (TangentSolver::assemble says why).
///
/// Returns the first element that is turned inside out (J not above 0, or not a number), or -1.
Index packed_tangent(const ElementPacks& packs, const Material& material, Index first, Index last,
                     const double* displacement, StoredPack* blocks, const double* increment = nullptr);

}  // namespace couplet::solid
