#pragma once
// What the tangents of all formulations share: sums over points and pairs of nodes of eight elements.

#include <algorithm>

#include "solid-server/element/packed_force.hpp"
#include "solid-server/element/packed_tangent.hpp"

namespace couplet::solid {

/// The packs [first, last) of a block, and where their tangents go; see packed_tangent.hpp.
struct TangentRequest {
  const ElementPacks& packs;
  Index first = 0, last = 0;
  const double* displacement = nullptr;
  const double* increment = nullptr;  // nullptr: none
  StoredPack* blocks = nullptr;
};

/// packed_tangent of one formulation.
Index standard_tangent(const TangentRequest& request, const Material& material);
Index near_incompressible_tangent(const TangentRequest& request, const Material& material);
Index stabilised_tangent(const TangentRequest& request, const Material& material);

// Points whose numbers stay in the first-level cache together.
constexpr int points_at_once = 8;

/// What the sums over points need of some points.
template <int n_nodes>
struct PointGroup {
  int n_points = 0;
  Pack gradient[points_at_once][n_nodes][3];   // dN_a/dX_J [1/m]
  BasicTangent<Pack> tangent[points_at_once];  // d2W/dF2 dV [J]
};

/// dN_a/dX_J at a point.
template <int n_nodes>
[[gnu::always_inline]] inline void gradient_in_space(const ElementPacks& packs, int point, const PointGeometry& g,
                                                     Pack (&gradient)[n_nodes][3]) {
  const double* natural = &packs.natural_gradient[static_cast<std::size_t>(3 * n_nodes * point)];
  for (int a = 0; a < n_nodes; ++a)
    for (int J = 0; J < 3; ++J)
      gradient[a][J] = natural[3 * a] * g.G[0][J] + natural[3 * a + 1] * g.G[1][J] + natural[3 * a + 2] * g.G[2][J];
}

/// F = I + sum of u_a (x) dN_a/dX.
template <int n_nodes>
[[gnu::always_inline]] inline Tensor<Pack> deformation_gradient(const NodePacks<n_nodes>& u,
                                                                const Pack (&gradient)[n_nodes][3]) {
  Tensor<Pack> F{};
  for (int i = 0; i < 3; ++i) F.at[i][i] += 1.0;
  for (int a = 0; a < n_nodes; ++a)
    for (int J = 0; J < 3; ++J)
      for (int i = 0; i < 3; ++i) F.at[i][J] += u[a][i] * gradient[a][J];
  return F;
}

[[gnu::always_inline]] inline void scale(const Pack& factor, BasicTangent<Pack>& tangent) {
  for (auto& row : tangent.at)
    for (Pack& entry : row) entry *= factor;
}

/// D, or 0 in the elements that F - D turns inside out: laws have no stress there.
[[gnu::always_inline]] inline Tensor<Pack> step_from_sound(const Tensor<Pack>& F, const Tensor<Pack>& D) {
  const Tensor<Pack> F_0 = sum(F, scaled(-1.0, D));
  const PackMask is_sound = determinant(F_0, cofactor(F_0)) > 0.0;
  Tensor<Pack> step;
  for (int n = 0; n < 9; ++n) step.at[n / 3][n % 3] = is_sound ? D.at[n / 3][n % 3] : Pack{};
  return step;
}

/// The step D = sum of d_a (x) dN_a/dX that led to F, as far as laws can follow it.
template <int n_nodes>
[[gnu::always_inline]] inline Tensor<Pack> step_gradient(const Pack (*d)[3], const Pack (&gradient)[n_nodes][3],
                                                         const Tensor<Pack>& F) {
  Tensor<Pack> D{};
  for (int a = 0; a < n_nodes; ++a)
    for (int J = 0; J < 3; ++J)
      for (int i = 0; i < 3; ++i) D.at[i][J] += d[a][i] * gradient[a][J];
  return step_from_sound(F, D);
}

/// U'' (dJ/dF) (x) (dJ/dF) + p d2J/dF2: what a part U(J) of the energy adds to d2W/dF2 under the pressure p.
[[gnu::always_inline]] inline void add_volume_terms(const Pack& pressure, const Pack& stiffness, const Tensor<Pack>& F,
                                                    BasicTangent<Pack>& tangent) {
  const Tensor<Pack> cof = cofactor(F);
  BasicTangent<Pack> upper{};
  add_outer_product(scaled(stiffness, cof), cof, upper);
  add_second_derivative_of_volume(pressure, F, upper);
  const BasicTangent<Pack> whole = mirrored(upper);
  for (int n = 0; n < 81; ++n) tangent.at[n / 9][n % 9] += whole.at[n / 9][n % 9];
}

/// d2W/dF2 at F, whose geometric part I (x) S takes the stress that is linear along the step D = grad d from F_0 = F -
/// D,
///   S = S_0 + F_0^-1 (dP - D S_0),  dP = (d2W/dF2)_0 D,
/// instead of that of F: S = F^-1 P is the second Piola-Kirchhoff stress, P = dW/dF.
template <class Law>
[[gnu::noinline]] BasicTangent<Pack> tangent_of_stress_after(const Law& law, const Tensor<Pack>& F,
                                                             const Tensor<Pack>& D, const LocalAxes<Pack>& axes) {
  const Tensor<Pack> F_0 = sum(F, scaled(-1.0, D)), P_0 = stress_of(law, F_0, axes);
  const Tensor<Pack> inverse_0 = inverse(F_0), S_0 = product(inverse_0, P_0);
  const BasicTangent<Pack> slope = tangent_of(law, F_0, axes);
  Tensor<Pack> P = sum(P_0, scaled(-1.0, product(D, S_0)));  // F_0 S
  for (int n = 0; n < 9; ++n)
    for (int m = 0; m < 9; ++m) P.at[n / 3][n % 3] += slope.at[n][m] * D.at[m / 3][m % 3];
  const Tensor<Pack> dS = sum(product(inverse_0, P), scaled(-1.0, product(inverse(F), stress_of(law, F, axes))));
  BasicTangent<Pack> tangent = tangent_of(law, F, axes);
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int L = 0; L < 3; ++L) tangent.at[3 * i + J][3 * i + L] += dS.at[J][L];
  return tangent;
}

/// U'(J_0) + U''(J_0) dJ: the pressure of U(J) that is linear along the step D from F_0.
template <class Law>
[[gnu::always_inline]] inline Pack pressure_after(const Law& law, const Tensor<Pack>& F, const Tensor<Pack>& D) {
  const Tensor<Pack> F_0 = sum(F, scaled(-1.0, D)), cof = cofactor(F_0);
  const Pack J = determinant(F_0, cof);
  return law.volumetric_part().pressure(J) + law.volumetric_part().stiffness(J) * double_contraction(cof, D);
}

/// The tangent of a point that came to F by the step D: stress and pressure are both linear along it.
template <class Law>
[[gnu::always_inline]] inline BasicTangent<Pack> tangent_after(const Law& law, const Tensor<Pack>& F,
                                                               const Tensor<Pack>& D, const LocalAxes<Pack>& axes) {
  if constexpr (Law::has_volumetric_part) {
    BasicTangent<Pack> tangent = tangent_of_stress_after(law.without_volumetric_part(), F, D, axes);
    add_volume_terms(pressure_after(law, F, D), law.volumetric_part().stiffness(determinant(F, cofactor(F))), F,
                     tangent);
    return tangent;
  } else {
    return tangent_of_stress_after(law, F, D, axes);
  }
}

/// Adds the points of a group to the blocks of all pairs of nodes, or sets them when it is the first.
template <int n_nodes>
void sum_points(const PointGroup<n_nodes>& group, bool is_first, StoredPack* blocks) {
  Pack side[points_at_once][3][3][3];  // d2W/dF_iJ dF_kL dN_b/dX_L dV, (i, k, J)
  for (int b = 0; b < n_nodes; ++b) {
    for (int q = 0; q < group.n_points; ++q) {
      const auto& A = group.tangent[q].at;
      const auto& g = group.gradient[q][b];
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
          for (int J = 0; J < 3; ++J)
            side[q][i][k][J] =
                A[3 * i + J][3 * k] * g[0] + A[3 * i + J][3 * k + 1] * g[1] + A[3 * i + J][3 * k + 2] * g[2];
    }
    for (int a = b; a < n_nodes; ++a, blocks += 9) {
      Pack sum[9]{};
      if (!is_first)
        for (int n = 0; n < 9; ++n) sum[n] = load(blocks[n]);
      for (int q = 0; q < group.n_points; ++q) {
        const Pack g0 = group.gradient[q][a][0], g1 = group.gradient[q][a][1], g2 = group.gradient[q][a][2];
        for (int n = 0; n < 9; ++n) {
          const Pack(&t)[3] = side[q][n / 3][n % 3];
          sum[n] += g0 * t[0] + g1 * t[1] + g2 * t[2];
        }
      }
      for (int n = 0; n < 9; ++n) store(sum[n], blocks[n]);
    }
  }
}

/// Goes through the packs; Element::tangent(packs, law, axes, geometry, u, d, blocks) writes the blocks of one and
/// returns where it is sound; d is the increment at the nodes or a null pointer.
template <class Element, class Law>
Index tangent_of_packs(const TangentRequest& request, const Law& law) {
  constexpr int n_nodes = Element::n_nodes;
  const ElementPacks& packs = request.packs;
  StoredPack* blocks = request.blocks;
  Index first_unsound = -1;
  for (Index p = request.first; p < request.last; ++p, blocks += 9 * n_local_pairs(n_nodes)) {
    NodePacks<n_nodes> u, d;
    const Index* start = &packs.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
    for (int a = 0; a < n_nodes; ++a) load_nodes(request.displacement, start + a * n_lanes, u[a][0], u[a][1], u[a][2]);
    if (request.increment)
      for (int a = 0; a < n_nodes; ++a) load_nodes(request.increment, start + a * n_lanes, d[a][0], d[a][1], d[a][2]);
    const StoredPack* geometry =
        &packs.geometry[static_cast<std::size_t>(packs.geometry_start[static_cast<std::size_t>(p)])];
    const PackMask is_sound =
        Element::tangent(packs, law, load_axes<Law>(packs, p), geometry, u, request.increment ? d : nullptr, blocks);
    if (first_unsound < 0 && !all_true(is_sound)) [[unlikely]]
      first_unsound = first_unsound_element(packs, p, is_sound);
  }
  return first_unsound;
}

}  // namespace couplet::solid
