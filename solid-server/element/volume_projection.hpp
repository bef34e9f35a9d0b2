#pragma once
// The projection of the volume ratio J onto the functions of an element that carry its pressure: {1, xi, eta, zeta} in
// hexahedra of 20 nodes, {1} in tetrahedra of 10. A mesh of hexahedra has twelve displacements and four conditions on
// its volume for each element, as many as the continuum; tetrahedra have four and one [Hughes 2000, 4.3: constraint
// counts].

#include <Eigen/Core>

#include "solid-server/element/deformation.hpp"
#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

constexpr int n_volume_functions(int n_nodes) {
  return n_nodes == 20 ? 4 : 1;
}

/// Share s of U that is felt at the points:  s U(J) + (1 - s) U(Jbar). With one function for the pressure, an element
/// would bend with its deviatoric part alone, half as stiff as it should be; ten times the shear modulus of the bulk
/// modulus at the points (Poisson's ratio 0.45) does not lock.
constexpr double pointwise_share(int n_functions, double shear_modulus, double bulk_modulus) {
  return n_functions > 1 ? 0 : bulk_modulus > 10 * shear_modulus ? 10 * shear_modulus / bulk_modulus : 1;
}

/// Entries of a symmetric matrix of that size, row by row of the upper half.
constexpr int n_gram_entries(int n_functions) {
  return n_functions * (n_functions + 1) / 2;
}

/// phi_A at a point.
Eigen::VectorXd volume_functions(ElementShape shape, const Eigen::Vector3d& xi);

/// The upper half of M^-1, M = sum over points of phi phi^T dV [1/m^3], row by row. `volume` of each point [m^3].
std::vector<double> inverse_gram_matrix(ElementShape shape, const std::vector<QuadraturePoint>& points,
                                        const std::vector<double>& volume);

/// One number for each function, in eight elements.
template <int n>
struct VolumeModes {
  Pack mode[n];

  /// += phi(point) value.
  [[gnu::always_inline]] inline void add(const ElementPacks& packs, int point, const Pack& value) {
    const double* phi = &packs.volume_function[static_cast<std::size_t>(point * n)];
    mode[0] += value;
    for (int A = 1; A < n; ++A) mode[A] += phi[A] * value;
  }

  /// phi(point) . modes.
  [[gnu::always_inline]] inline Pack at(const ElementPacks& packs, int point) const {
    const double* phi = &packs.volume_function[static_cast<std::size_t>(point * n)];
    Pack value = mode[0];
    for (int A = 1; A < n; ++A) value += phi[A] * mode[A];
    return value;
  }

  /// M^-1 times the modes.
  [[gnu::always_inline]] inline VolumeModes times(const StoredPack* inverse_gram) const {
    VolumeModes out{};
    for (int A = 0; A < n; ++A)
      for (int B = A; B < n; ++B) {
        const Pack entry = load(*inverse_gram++);
        out.mode[A] += entry * mode[B];
        if (B > A) out.mode[B] += entry * mode[A];
      }
    return out;
  }
};

}  // namespace couplet::solid
