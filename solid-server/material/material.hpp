#pragma once
// The materials that there are.

#include <concepts>
#include <variant>

#include "solid-server/material/mooney_rivlin.hpp"
#include "solid-server/material/pack.hpp"
#include "solid-server/material/saint_venant_kirchhoff.hpp"

namespace couplet::solid {

/// A hyperelastic material answers, at one point, for a deformation gradient F [1]:
///   energy(F) = W [J/m^3],  stress(F) = dW/dF [Pa] (first Piola-Kirchhoff),  tangent(F) = d2W/dF2 [Pa],
///   pressure_wave_modulus() = rho c_p^2 at rest [Pa],  needs_positive_volume: the formulas mean nothing for J <= 0.
/// It has no state and no mesh. energy and stress are templates: the kernel calls them for eight points at once. They
/// are always inlined there. Tests differentiate energy to check stress, and stress to check tangent, for every member
/// of Material.
template <class M>
concept HyperelasticMaterial = requires(const M material, const Tensor<double> F, const Tensor<Pack> packed) {
  { material.energy(F) } -> std::same_as<double>;
  { material.stress(F) } -> std::same_as<Tensor<double>>;
  { material.stress(packed) } -> std::same_as<Tensor<Pack>>;
  { material.tangent(F) } -> std::same_as<Tangent>;
  { material.pressure_wave_modulus() } -> std::same_as<double>;
  { M::needs_positive_volume } -> std::convertible_to<bool>;
};

static_assert(HyperelasticMaterial<SaintVenantKirchhoff>);
static_assert(HyperelasticMaterial<MooneyRivlin>);

using Material = std::variant<SaintVenantKirchhoff, MooneyRivlin>;

/// The answers of any law; `axes` are read by anisotropic laws only and may be left unset for others.
template <class Law, class Real>
[[gnu::always_inline]] inline Real energy_of(const Law& law, const Tensor<Real>& F, const LocalAxes<Real>&) {
  return law.energy(F);
}
template <class Law, class Real>
[[gnu::always_inline]] inline Tensor<Real> stress_of(const Law& law, const Tensor<Real>& F, const LocalAxes<Real>&) {
  return law.stress(F);
}
template <class Law, class Real>
inline Tangent tangent_of(const Law& law, const Tensor<Real>& F, const LocalAxes<Real>&) {
  return law.tangent(F);
}

}  // namespace couplet::solid
