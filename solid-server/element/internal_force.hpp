#pragma once
// The internal force of eight elements at once, total Lagrangian: the kernel in which a run spends its time.

#include "solid-server/element/element_packs.hpp"
#include "solid-server/element/lane_transpose.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

/// Start of the force (x, y, z, 0) on a local node of the element in a lane, counted in doubles from the place of its
/// pack.
constexpr Index force_start(int local_node, int lane) {
  return 4 * local_node * n_lanes + 4 * lane_place(lane);
}

/// What the kernel notices in elements beside their forces.
struct ElementFindings {
  Index inverted = -1;  // the first element that is turned inside out (J not above 0, or not a number), or -1
  Index softened = -1;  // the first one whose law answers more compression with less stress, or -1
  int n_softened = 0;   // how many of them
};

/// For the packs [first, last): minus the derivative of the strain energy by the displacement,
///   f_a = - sum over points of P(F) dN_a/dX dV,  F = I + sum_a u_a (x) dN_a/dX   [Belytschko, Liu, Moran 2000,
///   box 4.6],
/// into `force` [N], where each pack has its own place, the first one at the start; adding up the elements of a node is
/// assembly's work. `displacement` is a NodeVectors array [m]. With `energy`, also the strain energy of each element
/// [J], (n_packs).
///
/// Without `energy` only laws that need J look for inverted elements, and none looks at its stiffness.
ElementFindings internal_force(const ElementPacks& packs, const Material& material, Index first, Index last,
                               const double* displacement, StoredPack* force, StoredPack* energy);

}  // namespace couplet::solid
