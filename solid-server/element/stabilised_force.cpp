// The stabilised formulation of the 8-node hexahedron; stabilisation.hpp says what it is.

#include "solid-server/element/eight_point_gradient.hpp"
#include "solid-server/element/stabilised_hexahedron.hpp"

namespace couplet::solid {

namespace {

using namespace stabilisation;

struct StabilisedHexahedron {
  static constexpr int n_nodes = 8;

  template <bool with_energy, class Law>
  [[gnu::always_inline]] static inline PackSum force(const ElementPacks&, const Law& law, const LocalAxes<Pack>& axes,
                                                     const StoredPack* geometry, const NodePacks<n_nodes>& u,
                                                     NodePacks<n_nodes>& f) {
    const Deformation now(geometry, parts_of_modes(u));
    const Resultants resultant(moduli(law.shear_modulus(), law.bulk_modulus_at_rest()), geometry, now.a);
    const Pack volume = load(geometry[volume_at]);

    // Derivatives of the energy: t_k by q_k, r_j by d_j, Q by Fbar where d_j = Fbar g_j, q_k = U_hk - (Fbar - I) X_hk.
    Tensor<Pack> Q = scaled(volume, stress_of(law, now.F, axes));
    Pack t[4][3];
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) {
        t[k][i] = resultant.s[k][0] * now.d[0][i] + resultant.s[k][1] * now.d[1][i] + resultant.s[k][2] * now.d[2][i];
        for (int J = 0; J < 3; ++J) Q.at[i][J] -= t[k][i] * now.X[3 + k][J];
      }
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        Pack r = resultant.s[0][j] * now.q[0][i];
        for (int k = 1; k < 4; ++k) r += resultant.s[k][j] * now.q[k][i];
        for (int J = 0; J < 3; ++J) Q.at[i][J] += r * now.X[j][J];
      }

    for (int i = 0; i < 3; ++i) {
      Pack corner[8]{};
      for (int m = 0; m < n_modes; ++m) {
        Pack by_mode = dot(Q.at[i], now.B[m]);
        if (m >= 3) by_mode += t[m - 3][i];
        corner[mode_axes[static_cast<std::size_t>(m)]] = -0.125 * by_mode;
      }
      eight_points::to_values<3>(corner, 1);
      for (int c = 0; c < 8; ++c) f[eight_points::corner_node[c]][i] = corner[c];
    }

    PackSum total;
    if constexpr (with_energy) total.energy = volume * energy_of(law, now.F, axes) + resultant.energy;
    if constexpr (with_energy) note_stiffness(law, now.F, total);
    if constexpr (with_energy || Law::needs_positive_volume) total.is_sound = determinant(now.F, cofactor(now.F)) > 0.0;
    return total;
  }
};

}  // namespace

ElementFindings stabilised_force(const ForceRequest& request, const Material& material) {
  return std::visit([&](const auto& law) { return force_of_packs<StabilisedHexahedron>(request, law); }, material);
}

}  // namespace couplet::solid
