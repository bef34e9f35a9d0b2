// The tangent of the near-incompressible formulation (near_incompressible_force.cpp).

#include "solid-server/element/tangent_sums.hpp"
#include "solid-server/element/volume_projection.hpp"

namespace couplet::solid {

namespace {

/// Second derivative of the energy:
///   sum over points of grad N (d2W_1/dF2 + p d2J/dF2) grad N dV + b^T M^-1 V M^-1 b,
///   b_A = sum of phi_A cof F grad N dV,  V = sum of phi phi^T U''(Jbar) dV.
template <int n_element_nodes>
struct ProjectedVolume {
  static constexpr int n_nodes = n_element_nodes, n_functions = n_volume_functions(n_nodes);
  using Modes = VolumeModes<n_functions>;

  /// The parts that belong to the whole element.
  struct Volume {
    Modes pressure;  // that is linear along the step
    Modes b[n_nodes][3];
    Modes stiffness[n_functions];  // V, row by row
  };

  template <class Law>
  static PackMask tangent(const ElementPacks& packs, const Law& law, const LocalAxes<Pack>& axes,
                          const StoredPack* geometry, const NodePacks<n_nodes>& u, const Pack (*d)[3],
                          StoredPack* blocks) {
    Volume volume;
    const PackMask is_sound = fill(packs, law, geometry, u, d, volume);
    const Law isochoric = law.without_volumetric_part();
    const double share = pointwise_share(n_functions, law.shear_modulus(), law.bulk_modulus_at_rest());
    PointGroup<n_nodes> group;
    for (int first = 0; first < packs.n_points; first += points_at_once) {
      group.n_points = std::min(points_at_once, packs.n_points - first);
      for (int q = 0; q < group.n_points; ++q) {
        const PointGeometry g = load_geometry(geometry + 10 * (first + q));
        gradient_in_space<n_nodes>(packs, first + q, g, group.gradient[q]);
        const Tensor<Pack> F = deformation_gradient<n_nodes>(u, group.gradient[q]);
        Tensor<Pack> step{};
        if (d) step = step_gradient<n_nodes>(d, group.gradient[q], F);
        Pack p = volume.pressure.at(packs, first + q), stiffness{};
        if constexpr (n_functions == 1) {
          p = (1 - share) * p + share * pressure_after(law, F, step);
          stiffness = share * law.volumetric_part().stiffness(determinant(F, cofactor(F)));
        }
        group.tangent[q] = d ? tangent_of_stress_after(isochoric, F, step, axes) : tangent_of(isochoric, F, axes);
        add_volume_terms(p, stiffness, F, group.tangent[q]);
        scale(g.volume, group.tangent[q]);
      }
      sum_points(group, first == 0, blocks);
    }
    add_volume_stiffness(volume, geometry + 10 * packs.n_points, 1 - share, blocks);
    return is_sound;
  }

 private:
  template <class Law>
  static PackMask fill(const ElementPacks& packs, const Law& law, const StoredPack* geometry,
                       const NodePacks<n_nodes>& u, const Pack (*d)[3], Volume& out) {
    PackMask is_sound = Pack{} == 0.0;
    std::memset(&out, 0, sizeof out);
    Modes moment{}, moment_0{}, change_of_moment{};  // of J, and of J_0 and dJ of the step
    for (int q = 0; q < packs.n_points; ++q) {
      const PointGeometry g = load_geometry(geometry + 10 * q);
      Pack gradient[n_nodes][3];
      gradient_in_space<n_nodes>(packs, q, g, gradient);
      const Tensor<Pack> F = deformation_gradient<n_nodes>(u, gradient), cof = cofactor(F);
      const Pack J = determinant(F, cof);
      is_sound &= J > 0.0;
      moment.add(packs, q, J * g.volume);
      Tensor<Pack> step{};
      if (d) step = step_gradient<n_nodes>(d, gradient, F);
      const Tensor<Pack> F_0 = sum(F, scaled(-1.0, step)), cof_0 = cofactor(F_0);
      moment_0.add(packs, q, determinant(F_0, cof_0) * g.volume);
      change_of_moment.add(packs, q, double_contraction(cof_0, step) * g.volume);
      for (int a = 0; a < n_nodes; ++a)
        for (int i = 0; i < 3; ++i) {
          const Pack slope =
              cof.at[i][0] * gradient[a][0] + cof.at[i][1] * gradient[a][1] + cof.at[i][2] * gradient[a][2];
          out.b[a][i].add(packs, q, slope * g.volume);
        }
    }
    const StoredPack* inverse_gram = geometry + 10 * packs.n_points;
    const Modes Jbar = moment.times(inverse_gram), Jbar_0 = moment_0.times(inverse_gram);
    const Modes dJbar = change_of_moment.times(inverse_gram);
    Modes pressure_moment{};
    for (int q = 0; q < packs.n_points; ++q) {
      const Pack J = Jbar.at(packs, q), J_0 = Jbar_0.at(packs, q), volume = load(geometry[10 * q + 9]);
      is_sound &= J > 0.0;
      const Pack pressure =
          law.volumetric_part().pressure(J_0) + law.volumetric_part().stiffness(J_0) * dJbar.at(packs, q);
      pressure_moment.add(packs, q, pressure * volume);
      const double* phi = &packs.volume_function[static_cast<std::size_t>(q * n_functions)];
      for (int A = 0; A < n_functions; ++A)
        out.stiffness[A].add(packs, q, phi[A] * law.volumetric_part().stiffness(J) * volume);
    }
    out.pressure = pressure_moment.times(inverse_gram);
    return is_sound;
  }

  static void add_volume_stiffness(const Volume& volume, const StoredPack* inverse_gram, double share,
                                   StoredPack* blocks) {
    Modes left[n_nodes][3];  // M^-1 b
    for (int a = 0; a < n_nodes; ++a)
      for (int i = 0; i < 3; ++i) left[a][i] = volume.b[a][i].times(inverse_gram);
    for (int b = 0; b < n_nodes; ++b) {
      Modes right[3]{};  // V M^-1 b
      for (int k = 0; k < 3; ++k)
        for (int A = 0; A < n_functions; ++A)
          for (int B = 0; B < n_functions; ++B)
            right[k].mode[A] += share * volume.stiffness[A].mode[B] * left[b][k].mode[B];
      for (int a = b; a < n_nodes; ++a, blocks += 9)
        for (int n = 0; n < 9; ++n) {
          Pack sum = load(blocks[n]);
          for (int A = 0; A < n_functions; ++A) sum += left[a][n / 3].mode[A] * right[n % 3].mode[A];
          store(sum, blocks[n]);
        }
    }
  }
};

}  // namespace

Index near_incompressible_tangent(const TangentRequest& request, const Material& material) {
  return std::visit(
      [&]<class Law>(const Law& law) -> Index {
        if constexpr (Law::has_volumetric_part)
          return request.packs.shape == ElementShape::tetrahedron10
                     ? tangent_of_packs<ProjectedVolume<10>>(request, law)
                     : tangent_of_packs<ProjectedVolume<20>>(request, law);
        else
          __builtin_unreachable();  // refused by check_formulation
      },
      material);
}

}  // namespace couplet::solid
