#include "solid-server/element/packed_tangent.hpp"

#include <algorithm>

#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

// Points whose numbers stay in the first-level cache together.
constexpr int points_at_once = 8;

/// What the sums over points need of some points.
template <int n_nodes>
struct PointGroup {
  int n_points = 0;
  Pack gradient[points_at_once][n_nodes][3];   // dN_a/dX_J [1/m]
  BasicTangent<Pack> tangent[points_at_once];  // d2W/dF2 dV [J]
  PackMask is_sound = Pack{} == 0.0;
};

/// d2W/dF2 + I (x) dS: the change of the second Piola-Kirchhoff stress, dS = (d2W/dE2) dE, with the strain
/// dE = - (grad d)^T (grad d) / 2. It is found along dF = F^-T dE, which has this dE: dP = dF S + F dS.
template <class Law>
void add_stress_change(const Law& law, const LocalAxes<Pack>& axes, const Tensor<Pack>& F,
                       const Tensor<Pack>& increment_gradient, BasicTangent<Pack>& tangent) {
  const Tensor<Pack> cof = cofactor(F), P = stress_of(law, F, axes);
  const Pack inverse_J = 1.0 / determinant(F, cof);
  Tensor<Pack> dE{}, dF{}, rest{};
  for (int I = 0; I < 3; ++I)
    for (int J = 0; J < 3; ++J)
      for (int i = 0; i < 3; ++i) dE.at[I][J] -= 0.5 * increment_gradient.at[i][I] * increment_gradient.at[i][J];
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int I = 0; I < 3; ++I) dF.at[i][J] += inverse_J * cof.at[i][I] * dE.at[I][J];
  Tensor<Pack> S{};
  for (int I = 0; I < 3; ++I)
    for (int J = 0; J < 3; ++J)
      for (int i = 0; i < 3; ++i) S.at[I][J] += inverse_J * cof.at[i][I] * P.at[i][J];
  for (int i = 0; i < 3; ++i)  // F dS = dP - dF S
    for (int J = 0; J < 3; ++J) {
      for (int k = 0; k < 3; ++k)
        for (int L = 0; L < 3; ++L) rest.at[i][J] += tangent.at[3 * i + J][3 * k + L] * dF.at[k][L];
      for (int I = 0; I < 3; ++I) rest.at[i][J] -= dF.at[i][I] * S.at[I][J];
    }
  for (int J = 0; J < 3; ++J)
    for (int L = 0; L < 3; ++L) {
      Pack dS{};
      for (int i = 0; i < 3; ++i) dS += inverse_J * cof.at[i][J] * rest.at[i][L];
      for (int i = 0; i < 3; ++i) tangent.at[3 * i + J][3 * i + L] += dS;
    }
}

/// The standard formulation: F from the displacements at the point.
template <int n_element_nodes>
struct StandardPoints {
  static constexpr int n_nodes = n_element_nodes;

  template <class Law>
  static void fill(const ElementPacks& packs, const Law& law, const LocalAxes<Pack>& axes, const StoredPack* geometry,
                   const Pack (&u)[n_nodes][3], const Pack (*d)[3], int first, PointGroup<n_nodes>& group) {
    group.n_points = std::min(points_at_once, packs.n_points - first);
    for (int q = 0; q < group.n_points; ++q) {
      const double* natural = &packs.natural_gradient[static_cast<std::size_t>(3 * n_nodes * (first + q))];
      const StoredPack* stored = geometry + 10 * (first + q);
      Pack G[3][3];
      for (int k = 0; k < 3; ++k)
        for (int J = 0; J < 3; ++J) G[k][J] = load(stored[3 * k + J]);
      Tensor<Pack> F{}, increment_gradient{};
      for (int i = 0; i < 3; ++i) F.at[i][i] += 1.0;
      for (int a = 0; a < n_nodes; ++a)
        for (int J = 0; J < 3; ++J) {
          const Pack slope = natural[3 * a] * G[0][J] + natural[3 * a + 1] * G[1][J] + natural[3 * a + 2] * G[2][J];
          group.gradient[q][a][J] = slope;
          for (int i = 0; i < 3; ++i) F.at[i][J] += u[a][i] * slope;
          if (d)
            for (int i = 0; i < 3; ++i) increment_gradient.at[i][J] += d[a][i] * slope;
        }
      group.is_sound &= determinant(F, cofactor(F)) > 0.0;
      const Pack volume = load(stored[9]);
      group.tangent[q] = tangent_of(law, F, axes);
      if (d) add_stress_change(law, axes, F, increment_gradient, group.tangent[q]);
      for (auto& row : group.tangent[q].at)
        for (Pack& entry : row) entry *= volume;
    }
  }
};

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

template <class Law>
LocalAxes<Pack> load_axes(const ElementPacks& packs, Index p) {
  LocalAxes<Pack> axes{};
  if constexpr (Law::is_anisotropic)
    for (int axis = 0; axis < 2; ++axis)
      for (int J = 0; J < 3; ++J) axes.at[axis][J] = load(packs.axes[static_cast<std::size_t>(6 * p + 3 * axis + J)]);
  return axes;
}

template <class Points, class Law>
Index tangent_of_packs(const ElementPacks& packs, const Law& law, Index first, Index last, const double* displacement,
                       const double* increment, StoredPack* blocks) {
  constexpr int n_nodes = Points::n_nodes;
  Index first_unsound = -1;
  for (Index p = first; p < last; ++p, blocks += 9 * n_local_pairs(n_nodes)) {
    Pack u[n_nodes][3], d[n_nodes][3];
    const Index* start = &packs.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
    for (int a = 0; a < n_nodes; ++a) load_nodes(displacement, start + a * n_lanes, u[a][0], u[a][1], u[a][2]);
    if (increment)
      for (int a = 0; a < n_nodes; ++a) load_nodes(increment, start + a * n_lanes, d[a][0], d[a][1], d[a][2]);
    const StoredPack* geometry =
        &packs.geometry[static_cast<std::size_t>(packs.geometry_start[static_cast<std::size_t>(p)])];
    const LocalAxes<Pack> axes = load_axes<Law>(packs, p);
    PointGroup<n_nodes> group;
    for (int point = 0; point < packs.n_points; point += points_at_once) {
      Points::fill(packs, law, axes, geometry, u, increment ? d : nullptr, point, group);
      sum_points(group, point == 0, blocks);
    }
    if (first_unsound < 0 && !all_true(group.is_sound)) [[unlikely]] {
      int lane = 0;
      while (group.is_sound[lane] != 0) ++lane;
      first_unsound = packs.lane_element[static_cast<std::size_t>(p * n_lanes + lane)];
    }
  }
  return first_unsound;
}

}  // namespace

Index packed_tangent(const ElementPacks& packs, const Material& material, Index first, Index last,
                     const double* displacement, StoredPack* blocks, const double* increment) {
  return std::visit(
      [&](const auto& law) {
        const auto run = [&]<class Points>(Points) {
          return tangent_of_packs<Points>(packs, law, first, last, displacement, increment, blocks);
        };
        if (packs.n_nodes == 10) return run(StandardPoints<10>{});
        return run(StandardPoints<20>{});
      },
      material);
}

}  // namespace couplet::solid
