#pragma once
// The materials that there are, and what each must answer.

#include <concepts>
#include <variant>

#include "solid-server/material/holzapfel_gasser_ogden.hpp"
#include "solid-server/material/may_newman.hpp"
#include "solid-server/material/mooney_rivlin.hpp"
#include "solid-server/material/neo_hookean.hpp"
#include "solid-server/material/pack.hpp"
#include "solid-server/material/saint_venant_kirchhoff.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/material/volumetric_part.hpp"

namespace couplet::solid {

/// A hyperelastic material answers, at one point, for a deformation gradient F [1]:
///   energy(F) = W [J/m^3],  stress(F) = dW/dF [Pa] (first Piola-Kirchhoff),  tangent(F) = d2W/dF2 [Pa].
/// It has no state and no mesh. The three are templates over double and Pack, since kernels ask for eight points at
/// once, and are always inlined there. A law with `is_anisotropic` takes the axes of the tissue as second argument;
/// energy_of, stress_of and tangent_of below serve both kinds.
///
/// Numbers at rest [Pa], of small strain:
///   pressure_wave_modulus() = rho c_p^2, with fibres the largest over all directions, or a bound above it;
///   shear_modulus(), bulk_modulus_at_rest(): of the isotropic part, without fibres.
///
/// What the caller must know before:
///   is_anisotropic         the axes are needed; first_fibre(F, axes): of its first family;
///   needs_positive_volume  the formulas mean nothing for J <= 0; the caller looks at J;
///   has_volumetric_part    W = W_1(F) + U(J): volumetric_part() = U, without_volumetric_part() = the law of W_1 alone;
///   may_lose_stiffness     loses_stiffness(F) tells where the law answers more compression with less stress.
/// Tests differentiate energy to check stress, and stress to check tangent, for every member of Material.
template <class M>
concept IsotropicMaterial = requires(const M material, const Tensor<double> F, const Tensor<Pack> packed) {
  { material.energy(F) } -> std::same_as<double>;
  { material.stress(F) } -> std::same_as<Tensor<double>>;
  { material.tangent(F) } -> std::same_as<BasicTangent<double>>;
  { material.energy(packed) } -> std::same_as<Pack>;
  { material.stress(packed) } -> std::same_as<Tensor<Pack>>;
  { material.tangent(packed) } -> std::same_as<BasicTangent<Pack>>;
};

template <class M>
concept AnisotropicMaterial = requires(const M material, const Tensor<double> F, const Tensor<Pack> packed,
                                       const LocalAxes<double> axes, const LocalAxes<Pack> packed_axes) {
  { material.energy(F, axes) } -> std::same_as<double>;
  { material.stress(F, axes) } -> std::same_as<Tensor<double>>;
  { material.tangent(F, axes) } -> std::same_as<BasicTangent<double>>;
  { material.energy(packed, packed_axes) } -> std::same_as<Pack>;
  { material.stress(packed, packed_axes) } -> std::same_as<Tensor<Pack>>;
  { material.tangent(packed, packed_axes) } -> std::same_as<BasicTangent<Pack>>;
  { material.first_fibre(F, axes) } -> std::same_as<Fibre<double>>;
};

template <class M>
concept VolumetricMaterial = requires(const M material) {
  { material.volumetric_part() } -> std::same_as<VolumetricPart>;
  { material.without_volumetric_part() } -> std::same_as<M>;
};

template <class M>
concept MaterialThatMayLoseStiffness = requires(const M material, const Tensor<double> F, const Tensor<Pack> packed) {
  { material.loses_stiffness(F) } -> std::same_as<bool>;
  { material.loses_stiffness(packed) } -> std::same_as<PackMask>;
};

template <class M>
concept HyperelasticMaterial = (M::is_anisotropic ? AnisotropicMaterial<M> : IsotropicMaterial<M>)&&(
    !M::has_volumetric_part || VolumetricMaterial<M>)&&(!M::may_lose_stiffness ||
                                                        MaterialThatMayLoseStiffness<M>)&&requires(const M material) {
  { material.pressure_wave_modulus() } -> std::same_as<double>;
  { material.shear_modulus() } -> std::same_as<double>;
  { material.bulk_modulus_at_rest() } -> std::same_as<double>;
  { M::needs_positive_volume } -> std::convertible_to<bool>;
};

static_assert(HyperelasticMaterial<SaintVenantKirchhoff>);
static_assert(HyperelasticMaterial<NeoHookean>);
static_assert(HyperelasticMaterial<MooneyRivlin>);
static_assert(HyperelasticMaterial<HolzapfelGasserOgden>);
static_assert(HyperelasticMaterial<MayNewman>);

using Material = std::variant<SaintVenantKirchhoff, NeoHookean, MooneyRivlin, HolzapfelGasserOgden, MayNewman>;

/// The answers of any law; `axes` are read by anisotropic laws only and may be left unset for others.
template <HyperelasticMaterial Law, class Real>
[[gnu::always_inline]] inline Real energy_of(const Law& law, const Tensor<Real>& F,
                                             [[maybe_unused]] const LocalAxes<Real>& axes) {
  if constexpr (Law::is_anisotropic)
    return law.energy(F, axes);
  else
    return law.energy(F);
}

template <HyperelasticMaterial Law, class Real>
[[gnu::always_inline]] inline Tensor<Real> stress_of(const Law& law, const Tensor<Real>& F,
                                                     [[maybe_unused]] const LocalAxes<Real>& axes) {
  if constexpr (Law::is_anisotropic)
    return law.stress(F, axes);
  else
    return law.stress(F);
}

template <HyperelasticMaterial Law, class Real>
[[gnu::always_inline]] inline BasicTangent<Real> tangent_of(const Law& law, const Tensor<Real>& F,
                                                            [[maybe_unused]] const LocalAxes<Real>& axes) {
  if constexpr (Law::is_anisotropic)
    return law.tangent(F, axes);
  else
    return law.tangent(F);
}

}  // namespace couplet::solid
