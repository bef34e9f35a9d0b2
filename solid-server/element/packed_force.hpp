#pragma once
// What the internal-force kernels of all formulations share: eight elements from memory to packs and back. Each
// formulation has a file of its own, so that they compile side by side.

#include "solid-server/element/internal_force.hpp"

namespace couplet::solid {

/// The packs [first, last) of a block, and where their forces go; see internal_force.hpp.
struct ForceRequest {
  const ElementPacks& packs;
  Index first = 0, last = 0;
  const double* displacement = nullptr;
  StoredPack* force = nullptr;
  StoredPack* energy = nullptr;  // nullptr: not wanted
};

/// internal_force of one formulation.
ElementFindings standard_force(const ForceRequest& request, const Material& material);
ElementFindings near_incompressible_force(const ForceRequest& request, const Material& material);
ElementFindings stabilised_force(const ForceRequest& request, const Material& material);

template <int n_nodes>
using NodePacks = Pack[n_nodes][3];

/// G = dxi/dX and dV of eight elements at one point.
struct PointGeometry {
  Pack G[3][3], volume;
};

[[gnu::always_inline]] inline PointGeometry load_geometry(const StoredPack* stored) {
  PointGeometry geometry;
  for (int k = 0; k < 3; ++k)
    for (int J = 0; J < 3; ++J) geometry.G[k][J] = load(stored[3 * k + J]);
  geometry.volume = load(stored[9]);
  return geometry;
}

/// F = I + du/dxi G.
[[gnu::always_inline]] inline Tensor<Pack> deformation_gradient(const Pack (&slope)[3][3], const PointGeometry& g) {
  Tensor<Pack> F;
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J) {
      F.at[i][J] = slope[i][0] * g.G[0][J] + slope[i][1] * g.G[1][J] + slope[i][2] * g.G[2][J];
      if (i == J) F.at[i][J] += 1.0;
    }
  return F;
}

/// - P_iJ G_kJ dV: the force on node a is flux_ik dN_a/dxi_k.
[[gnu::always_inline]] inline void flux_of_stress(const Tensor<Pack>& P, const PointGeometry& g, Pack (&flux)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      flux[i][k] = -g.volume * (P.at[i][0] * g.G[k][0] + P.at[i][1] * g.G[k][1] + P.at[i][2] * g.G[k][2]);
}

/// What the points of a pack of elements add up to besides forces.
struct PackSum {
  Pack energy{};
  PackMask is_sound = Pack{} == 0.0;
  PackMask is_stiff = Pack{} == 0.0;  // looked at with energy
};

template <class Law>
[[gnu::always_inline]] inline LocalAxes<Pack> load_axes(const ElementPacks& packs, Index p) {
  LocalAxes<Pack> axes;
  if constexpr (Law::is_anisotropic)
    for (int axis = 0; axis < 2; ++axis)
      for (int J = 0; J < 3; ++J) axes.at[axis][J] = load(packs.axes[static_cast<std::size_t>(6 * p + 3 * axis + J)]);
  return axes;
}

/// The element in the first lane that is not sound; there must be one.
[[gnu::always_inline]] inline Index first_unsound_element(const ElementPacks& packs, Index p,
                                                          const PackMask& is_sound) {
  int lane = 0;
  while (is_sound[lane] != 0) ++lane;
  return packs.lane_element[static_cast<std::size_t>(p * n_lanes + lane)];
}

/// Adds the elements of a pack that are no longer stiff.
void note_softened(const ElementPacks& packs, Index p, const PackMask& is_stiff, ElementFindings& findings);

/// Whether the law loses its stiffness at a point of eight elements.
template <class Law>
[[gnu::always_inline]] inline void note_stiffness(const Law& law, const Tensor<Pack>& F, PackSum& sum) {
  if constexpr (Law::may_lose_stiffness) sum.is_stiff &= !law.loses_stiffness(F);
}

/// Goes through the packs; Element::force<with_energy>(packs, law, axes, geometry, u, f) answers for one, from the
/// displacements u of its nodes to their forces f.
template <class Element, bool with_energy, class Law>
ElementFindings force_of_packs(const ForceRequest& request, const Law& law) {
  constexpr int n_nodes = Element::n_nodes;
  const ElementPacks& packs = request.packs;
  ElementFindings findings;
  for (Index p = request.first; p < request.last; ++p) {
    NodePacks<n_nodes> u, f;
    const Index* start = &packs.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
    for (int a = 0; a < n_nodes; ++a) load_nodes(request.displacement, start + a * n_lanes, u[a][0], u[a][1], u[a][2]);

    const StoredPack* geometry =
        &packs.geometry[static_cast<std::size_t>(packs.geometry_start[static_cast<std::size_t>(p)])];
    const PackSum sum = Element::template force<with_energy>(packs, law, load_axes<Law>(packs, p), geometry, u, f);

    StoredPack* out = request.force + static_cast<std::size_t>((p - request.first) * packs.packs_of_force());
    for (int a = 0; a < n_nodes; ++a) store_nodes(f[a][0], f[a][1], f[a][2], out + 4 * a);
    if constexpr (with_energy) store(sum.energy, request.energy[p]);
    if (findings.inverted < 0 && !all_true(sum.is_sound)) [[unlikely]]
      findings.inverted = first_unsound_element(packs, p, sum.is_sound);
    if constexpr (with_energy && Law::may_lose_stiffness)
      if (!all_true(sum.is_stiff)) [[unlikely]]
        note_softened(packs, p, sum.is_stiff, findings);
  }
  return findings;
}

template <class Element, class Law>
ElementFindings force_of_packs(const ForceRequest& request, const Law& law) {
  return request.energy ? force_of_packs<Element, true>(request, law) : force_of_packs<Element, false>(request, law);
}

}  // namespace couplet::solid
