#include "solid-server/element/internal_force.hpp"

#include <algorithm>

#include "solid-server/element/eight_point_gradient.hpp"
#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

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

/// What is known at a point after the material has answered.
struct PointAnswer {
  Pack flux[3][3];  // - P_iJ G_kJ dV: the force on node a is flux_ik dN_a/dxi_k
  Pack energy;
  PackMask is_sound;
};

/// From du_i/dxi_k to the flux.
template <bool with_energy, class Law>
[[gnu::always_inline]] inline PointAnswer answer(const Law& law, const LocalAxes<Pack>& axes, const Pack (&slope)[3][3],
                                                 const StoredPack* stored) {
  const PointGeometry g = load_geometry(stored);
  Tensor<Pack> F;
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J) {
      F.at[i][J] = slope[i][0] * g.G[0][J] + slope[i][1] * g.G[1][J] + slope[i][2] * g.G[2][J];
      if (i == J) F.at[i][J] += 1.0;
    }
  const Tensor<Pack> P = stress_of(law, F, axes);
  PointAnswer out;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      out.flux[i][k] = -g.volume * (P.at[i][0] * g.G[k][0] + P.at[i][1] * g.G[k][1] + P.at[i][2] * g.G[k][2]);
  if constexpr (with_energy) out.energy = g.volume * energy_of(law, F, axes);
  if constexpr (with_energy || Law::needs_positive_volume) out.is_sound = determinant(F, cofactor(F)) > 0.0;
  return out;
}

/// What the points of a pack of elements add up to besides forces.
struct PackSum {
  Pack energy{};
  PackMask is_sound = Pack{} == 0.0;

  template <bool with_energy, class Law>
  [[gnu::always_inline]] inline void add(const Law&, const PointAnswer& point) {
    if constexpr (with_energy) energy += point.energy;
    if constexpr (with_energy || Law::needs_positive_volume) is_sound &= point.is_sound;
  }
};

/// 20-node hexahedra with eight points: gradients at all points at once, by butterflies.
struct EightPoints {
  static constexpr int n_nodes = 20;

  template <bool with_energy, class Law>
  [[gnu::always_inline]] static inline PackSum force(const ElementPacks&, const Law& law, const LocalAxes<Pack>& axes,
                                                     const StoredPack* geometry, const NodePacks<n_nodes>& u,
                                                     NodePacks<n_nodes>& f) {
    Pack slope[8][3][3];
    PackSum sum;
    for (int i = 0; i < 3; ++i) eight_points::gradient(u, i, slope);
    for (int q = 0; q < 8; ++q) {
      const PointAnswer point = answer<with_energy>(law, axes, slope[q], geometry + 10 * q);
      std::memcpy(&slope[q], &point.flux, sizeof point.flux);
      sum.add<with_energy>(law, point);
    }
    for (int i = 0; i < 3; ++i) eight_points::transposed_gradient(slope, i, f);
    return sum;
  }
};

/// Any element and points: sums over the nodes, point by point.
template <int n_element_nodes>
struct AnyPoints {
  static constexpr int n_nodes = n_element_nodes;

  template <bool with_energy, class Law>
  [[gnu::always_inline]] static inline PackSum force(const ElementPacks& packs, const Law& law,
                                                     const LocalAxes<Pack>& axes, const StoredPack* geometry,
                                                     const NodePacks<n_nodes>& u, NodePacks<n_nodes>& f) {
    const double* gradient = packs.natural_gradient.data();
    PackSum sum;
    std::memset(&f, 0, sizeof f);
    for (int q = 0; q < packs.n_points; ++q, gradient += 3 * n_nodes) {
      Pack slope[3][3]{};
      for (int a = 0; a < n_nodes; ++a)
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) slope[i][k] += u[a][i] * gradient[3 * a + k];
      const PointAnswer point = answer<with_energy>(law, axes, slope, geometry + 10 * q);
      for (int a = 0; a < n_nodes; ++a)
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) f[a][i] += point.flux[i][k] * gradient[3 * a + k];
      sum.add<with_energy>(law, point);
    }
    return sum;
  }
};

template <class Law>
[[gnu::always_inline]] inline LocalAxes<Pack> load_axes(const ElementPacks& packs, Index p) {
  LocalAxes<Pack> axes;
  if constexpr (Law::is_anisotropic)
    for (int axis = 0; axis < 2; ++axis)
      for (int J = 0; J < 3; ++J) axes.at[axis][J] = load(packs.axes[static_cast<std::size_t>(6 * p + 3 * axis + J)]);
  return axes;
}

template <class Points, bool with_energy, class Law>
Index force_of_packs(const ElementPacks& packs, const Law& law, Index first, Index last, const double* displacement,
                     StoredPack* force, StoredPack* energy) {
  constexpr int n_nodes = Points::n_nodes;
  Index first_unsound = -1;
  for (Index p = first; p < last; ++p) {
    NodePacks<n_nodes> u, f;
    const Index* start = &packs.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
    for (int a = 0; a < n_nodes; ++a) load_nodes(displacement, start + a * n_lanes, u[a][0], u[a][1], u[a][2]);

    const StoredPack* geometry =
        &packs.geometry[static_cast<std::size_t>(packs.geometry_start[static_cast<std::size_t>(p)])];
    const PackSum sum = Points::template force<with_energy>(packs, law, load_axes<Law>(packs, p), geometry, u, f);

    StoredPack* out = force + static_cast<std::size_t>((p - first) * packs.packs_of_force());
    for (int a = 0; a < n_nodes; ++a) store_nodes(f[a][0], f[a][1], f[a][2], out + 4 * a);
    if constexpr (with_energy) store(sum.energy, energy[p]);
    if (first_unsound < 0 && !all_true(sum.is_sound)) [[unlikely]] {
      int lane = 0;
      while (sum.is_sound[lane] != 0) ++lane;
      first_unsound = packs.lane_element[static_cast<std::size_t>(p * n_lanes + lane)];
    }
  }
  return first_unsound;
}

}  // namespace

Index internal_force(const ElementPacks& packs, const Material& material, Index first, Index last,
                     const double* displacement, StoredPack* force, StoredPack* energy) {
  return std::visit(
      [&](const auto& law) {
        const auto run = [&]<class Points>(Points) {
          return energy ? force_of_packs<Points, true>(packs, law, first, last, displacement, force, energy)
                        : force_of_packs<Points, false>(packs, law, first, last, displacement, force, energy);
        };
        if (packs.n_nodes == 10) return run(AnyPoints<10>{});
        return packs.n_points == 8 ? run(EightPoints{}) : run(AnyPoints<20>{});
      },
      material);
}

}  // namespace couplet::solid
