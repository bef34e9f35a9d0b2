// The tangent of the stabilised 8-node hexahedron (stabilisation.hpp).

#include "solid-server/element/eight_point_gradient.hpp"
#include "solid-server/element/stabilised_hexahedron.hpp"
#include "solid-server/element/tangent_sums.hpp"

namespace couplet::solid {

namespace {

using namespace stabilisation;

/// A displacement of mode m in direction i changes Fbar by e_i (x) B_m, q_k by c_mk e_i and d_j by e_mj e_i,
///   c_mk = delta_(m h_k) - B_m . X_hk,  e_mj = B_m . g_j,
/// hence a_kj by the component i of w_mkj = c_mk d_j + e_mj q_k. With the energy E(a) of stabilisation, s = dE/da,
///   K_mn = volume B_m d2W/dF2 B_n + sum of w_mkj d2E/da2 w_nk'j' + I sum of s_kj (c_mk e_nj + e_mj c_nk).
struct StabilisedHexahedron {
  static constexpr int n_nodes = 8;

  template <class Law>
  static PackMask tangent(const ElementPacks&, const Law& law, const LocalAxes<Pack>& axes, const StoredPack* geometry,
                          const NodePacks<n_nodes>& u, const Pack (*d)[3], StoredPack* blocks) {
    const Deformation now(geometry, parts_of_modes(u));
    const Moduli modulus = moduli(law.shear_modulus(), law.bulk_modulus_at_rest());
    BasicTangent<Pack> slope;
    Pack a[4][3];  // whose resultants the geometric stiffness takes
    std::memcpy(&a, &now.a, sizeof a);
    if (d) {
      // Along the step a_kj is to be linear, like the stress: it loses the product of the changes of d_j and q_k.
      NodePacks<n_nodes> increment;
      std::memcpy(&increment, d, sizeof increment);
      Deformation by(geometry, parts_of_modes(increment));
      for (int i = 0; i < 3; ++i) by.F.at[i][i] -= 1.0;
      slope = tangent_after(law, now.F, step_from_sound(now.F, by.F), axes);
      for (int j = 0; j < 3; ++j) {
        Pack change[3];  // of d_j
        for (int i = 0; i < 3; ++i) change[i] = dot(by.F.at[i], now.X[j]);
        for (int k = 0; k < 4; ++k) a[k][j] -= dot(change, by.q[k]);
      }
    } else {
      slope = tangent_of(law, now.F, axes);
    }
    const Resultants resultant(modulus, geometry, a);
    scale(load(geometry[volume_at]), slope);

    Pack c[n_modes][4], e[n_modes][3];
    for (int m = 0; m < n_modes; ++m) {
      for (int k = 0; k < 4; ++k) c[m][k] = (m == 3 + k ? 1.0 : 0.0) - dot(now.B[m], now.X[3 + k]);
      for (int j = 0; j < 3; ++j) e[m][j] = dot(now.B[m], now.X[j]);
    }
    const auto w = [&](int m, int i, Pack(&change)[4][3]) {
      for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 3; ++j) change[k][j] = c[m][k] * now.d[j][i] + e[m][j] * now.q[k][i];
    };

    Pack K[3][3][8][8];  // of the modes, by their sets of axes; mode 0 is a translation, without stiffness
    std::memset(&K, 0, sizeof K);
    for (int n = 0; n < n_modes; ++n)
      for (int k = 0; k < 3; ++k) {
        Pack change[4][3];
        w(n, k, change);
        const Resultants answer(modulus, geometry, change);  // d2E/da2 w_n: s is linear in a
        Pack side[3][3];                                     // volume d2W/dF_iJ dF_kL B_nL, (i, J)
        for (int i = 0; i < 3; ++i)
          for (int J = 0; J < 3; ++J)
            side[i][J] = slope.at[3 * i + J][3 * k] * now.B[n][0] + slope.at[3 * i + J][3 * k + 1] * now.B[n][1] +
                         slope.at[3 * i + J][3 * k + 2] * now.B[n][2];
        for (int m = 0; m < n_modes; ++m)
          for (int i = 0; i < 3; ++i) {
            Pack of_mode[4][3];
            w(m, i, of_mode);
            Pack sum = dot(now.B[m], side[i]);
            for (int h = 0; h < 4; ++h) sum += dot(of_mode[h], answer.s[h]);
            if (i == k)
              for (int h = 0; h < 4; ++h)
                for (int j = 0; j < 3; ++j) sum += resultant.s[h][j] * (c[m][h] * e[n][j] + e[m][j] * c[n][h]);
            K[i][k][mode_axes[static_cast<std::size_t>(m)]][mode_axes[static_cast<std::size_t>(n)]] = (1.0 / 64) * sum;
          }
      }
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) write_nodes(K[i][k], 3 * i + k, blocks);
    return determinant(now.F, cofactor(now.F)) > 0.0;
  }

 private:
  /// From modes to corners on both sides.
  static void write_nodes(Pack (&K)[8][8], int component, StoredPack* blocks) {
    for (auto& row : K) eight_points::to_values<3>(row, 1);
    for (int column = 0; column < 8; ++column) {
      Pack values[8];
      for (int set = 0; set < 8; ++set) values[set] = K[set][column];
      eight_points::to_values<3>(values, 1);
      const int b = eight_points::corner_node[column];
      for (int corner = 0; corner < 8; ++corner)
        if (const int a = eight_points::corner_node[corner]; a >= b)
          store(values[corner], blocks[9 * local_pair(n_nodes, a, b) + component]);
    }
  }
};

}  // namespace

Index stabilised_tangent(const TangentRequest& request, const Material& material) {
  return std::visit([&](const auto& law) { return tangent_of_packs<StabilisedHexahedron>(request, law); }, material);
}

}  // namespace couplet::solid
