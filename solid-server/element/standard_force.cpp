// The standard formulation: F at every point from the displacements.

#include "solid-server/element/packed_gradient.hpp"

namespace couplet::solid {

namespace {

/// From du_i/dxi_k to the flux, and what is added up over the points.
template <bool with_energy, class Law>
[[gnu::always_inline]] inline void answer(const Law& law, const LocalAxes<Pack>& axes, const Pack (&slope)[3][3],
                                          const StoredPack* stored, Pack (&flux)[3][3], PackSum& sum) {
  const PointGeometry g = load_geometry(stored);
  const Tensor<Pack> F = deformation_gradient(slope, g);
  flux_of_stress(stress_of(law, F, axes), g, flux);
  if constexpr (with_energy) sum.energy += g.volume * energy_of(law, F, axes);
  if constexpr (with_energy) note_stiffness(law, F, sum);
  if constexpr (with_energy || Law::needs_positive_volume) sum.is_sound &= determinant(F, cofactor(F)) > 0.0;
}

/// 20-node hexahedra with 8 or 27 points: the gradients of all points at once.
template <class Gradient>
struct AllPoints {
  static constexpr int n_nodes = Gradient::n_nodes;

  template <bool with_energy, class Law>
  [[gnu::always_inline]] static inline PackSum force(const ElementPacks& packs, const Law& law,
                                                     const LocalAxes<Pack>& axes, const StoredPack* geometry,
                                                     const NodePacks<n_nodes>& u, NodePacks<n_nodes>& f) {
    Pack slope[Gradient::max_points][3][3];
    PackSum sum;
    Gradient::gradient(packs, u, slope);
    for (int q = 0; q < Gradient::max_points; ++q) {
      Pack flux[3][3];
      answer<with_energy>(law, axes, slope[q], geometry + 10 * q, flux, sum);
      std::memcpy(&slope[q], &flux, sizeof flux);
    }
    Gradient::transposed_gradient(packs, slope, f);
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
      Pack slope[3][3], flux[3][3];
      gradient_at_point<n_nodes>(u, gradient, slope);
      answer<with_energy>(law, axes, slope, geometry + 10 * q, flux, sum);
      add_flux_at_point<n_nodes>(flux, gradient, f);
    }
    return sum;
  }
};

}  // namespace

ElementFindings standard_force(const ForceRequest& request, const Material& material) {
  return std::visit(
      [&](const auto& law) {
        switch (request.packs.shape) {
          case ElementShape::tetrahedron10:
            return force_of_packs<AnyPoints<10>>(request, law);
          case ElementShape::hexahedron8:
            return force_of_packs<AnyPoints<8>>(request, law);
          case ElementShape::hexahedron20:
            if (request.packs.n_points == 8) return force_of_packs<AllPoints<EightPointGradient>>(request, law);
            if (request.packs.n_points == 27) return force_of_packs<AllPoints<TwentySevenPointGradient>>(request, law);
            return force_of_packs<AnyPoints<20>>(request, law);
        }
        __builtin_unreachable();
      },
      material);
}

}  // namespace couplet::solid
