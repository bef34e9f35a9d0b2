// The near-incompressible formulation: a law W_1(F) + U(J) sees J only through its projection onto the linear functions
// phi_A of the element (volume_projection.hpp), so that an element has four conditions on its volume instead of one at
// each point.

#include "solid-server/element/packed_gradient.hpp"
#include "solid-server/element/volume_projection.hpp"

namespace couplet::solid {

namespace {

/// Energy = sum of W_1(F) dV + sum of U(Jbar) dV,  Jbar = phi . M^-1 sum of phi J dV,  M = sum of phi phi^T dV.
/// Its derivative has the pressure p = phi . M^-1 sum of phi U'(Jbar) dV:  P = dW_1/dF + p cof F
/// [Simo, Taylor, Pister 1985, with the element's linear functions for the constant].
template <class Gradient>
struct ProjectedVolume {
  static constexpr int n_nodes = Gradient::n_nodes, n_functions = n_volume_functions(n_nodes);

  template <bool with_energy, class Law>
  [[gnu::always_inline]] static inline PackSum force(const ElementPacks& packs, const Law& law,
                                                     const LocalAxes<Pack>& axes, const StoredPack* geometry,
                                                     const NodePacks<n_nodes>& u, NodePacks<n_nodes>& f) {
    Pack slope[Gradient::max_points][3][3];
    PackSum total;
    const double share = pointwise_share(n_functions, law.shear_modulus(), law.bulk_modulus_at_rest());
    Gradient::gradient(packs, u, slope);

    VolumeModes<n_functions> moment{};  // sums of phi J dV
    for (int q = 0; q < packs.n_points; ++q) {
      const PointGeometry g = load_geometry(geometry + 10 * q);
      const Tensor<Pack> F = deformation_gradient(slope[q], g);
      const Pack J = determinant(F, cofactor(F));
      total.is_sound &= J > 0.0;
      moment.add(packs, q, J * g.volume);
    }
    const StoredPack* inverse_gram = geometry + 10 * packs.n_points;
    const VolumeModes<n_functions> Jbar = moment.times(inverse_gram);

    VolumeModes<n_functions> pressure_moment{};  // sums of phi U'(Jbar) dV
    for (int q = 0; q < packs.n_points; ++q) {
      const Pack J = Jbar.at(packs, q), volume = load(geometry[10 * q + 9]);
      total.is_sound &= J > 0.0;
      pressure_moment.add(packs, q, law.volumetric_part().pressure(J) * volume);
      if constexpr (with_energy) total.energy += (1 - share) * law.volumetric_part().energy(J) * volume;
    }
    const VolumeModes<n_functions> pressure = pressure_moment.times(inverse_gram);

    const Law isochoric = law.without_volumetric_part();
    for (int q = 0; q < packs.n_points; ++q) {
      const PointGeometry g = load_geometry(geometry + 10 * q);
      const Tensor<Pack> F = deformation_gradient(slope[q], g), cof = cofactor(F);
      Pack p = pressure.at(packs, q);
      if constexpr (with_energy) total.energy += g.volume * energy_of(isochoric, F, axes);
      if constexpr (n_functions == 1) {
        const Pack J = determinant(F, cof);
        p = (1 - share) * p + share * law.volumetric_part().pressure(J);
        if constexpr (with_energy) total.energy += share * g.volume * law.volumetric_part().energy(J);
      }
      const Tensor<Pack> P = sum(stress_of(isochoric, F, axes), scaled(p, cof));
      Pack flux[3][3];
      flux_of_stress(P, g, flux);
      std::memcpy(&slope[q], &flux, sizeof flux);
    }
    Gradient::transposed_gradient(packs, slope, f);
    return total;
  }
};

}  // namespace

ElementFindings near_incompressible_force(const ForceRequest& request, const Material& material) {
  return std::visit(
      [&]<class Law>(const Law& law) -> ElementFindings {
        if constexpr (Law::has_volumetric_part) {
          if (request.packs.shape == ElementShape::tetrahedron10)
            return force_of_packs<ProjectedVolume<AnyPointGradient<10, 4>>>(request, law);
          if (request.packs.n_points == 8) return force_of_packs<ProjectedVolume<EightPointGradient>>(request, law);
          if (request.packs.n_points == 27)
            return force_of_packs<ProjectedVolume<TwentySevenPointGradient>>(request, law);
          return force_of_packs<ProjectedVolume<AnyPointGradient<20, 14>>>(request, law);
        } else {
          __builtin_unreachable();  // refused by check_formulation
        }
      },
      material);
}

}  // namespace couplet::solid
