#pragma once
// Derivatives of nodal values at the points of eight elements, and the transpose: by the element's polynomial where it
// serves, by sums over the nodes elsewhere.

#include "solid-server/element/eight_point_gradient.hpp"
#include "solid-server/element/packed_force.hpp"
#include "solid-server/element/twenty_seven_point_gradient.hpp"

namespace couplet::solid {

/// du_i/dxi_k = sum over nodes of u_a dN_a/dxi_k.
template <int n_nodes>
[[gnu::always_inline]] inline void gradient_at_point(const NodePacks<n_nodes>& u, const double* gradient,
                                                     Pack (&slope)[3][3]) {
  std::memset(&slope, 0, sizeof slope);
  for (int a = 0; a < n_nodes; ++a)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) slope[i][k] += u[a][i] * gradient[3 * a + k];
}

/// f_a += flux_ik dN_a/dxi_k.
template <int n_nodes>
[[gnu::always_inline]] inline void add_flux_at_point(const Pack (&flux)[3][3], const double* gradient,
                                                     NodePacks<n_nodes>& f) {
  for (int a = 0; a < n_nodes; ++a)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) f[a][i] += flux[i][k] * gradient[3 * a + k];
}

/// 20-node hexahedra with eight points: all points at once, by butterflies.
struct EightPointGradient {
  static constexpr int n_nodes = 20, max_points = 8;

  [[gnu::always_inline]] static inline void gradient(const ElementPacks&, const NodePacks<n_nodes>& u,
                                                     Pack (&slope)[max_points][3][3]) {
    for (int i = 0; i < 3; ++i) eight_points::gradient(u, i, slope);
  }
  [[gnu::always_inline]] static inline void transposed_gradient(const ElementPacks&,
                                                                const Pack (&flux)[max_points][3][3],
                                                                NodePacks<n_nodes>& f) {
    for (int i = 0; i < 3; ++i) eight_points::transposed_gradient(flux, i, f);
  }
};

/// Likewise with 27 points.
struct TwentySevenPointGradient {
  static constexpr int n_nodes = 20, max_points = 27;

  [[gnu::always_inline]] static inline void gradient(const ElementPacks&, const NodePacks<n_nodes>& u,
                                                     Pack (&slope)[max_points][3][3]) {
    for (int i = 0; i < 3; ++i) twenty_seven_points::gradient(u, i, slope);
  }
  [[gnu::always_inline]] static inline void transposed_gradient(const ElementPacks&,
                                                                const Pack (&flux)[max_points][3][3],
                                                                NodePacks<n_nodes>& f) {
    for (int i = 0; i < 3; ++i) twenty_seven_points::transposed_gradient(flux, i, f);
  }
};

/// Any element and points.
template <int n_element_nodes, int n_points_max>
struct AnyPointGradient {
  static constexpr int n_nodes = n_element_nodes, max_points = n_points_max;

  [[gnu::always_inline]] static inline void gradient(const ElementPacks& packs, const NodePacks<n_nodes>& u,
                                                     Pack (&slope)[max_points][3][3]) {
    const double* gradient = packs.natural_gradient.data();
    for (int q = 0; q < packs.n_points; ++q, gradient += 3 * n_nodes) gradient_at_point<n_nodes>(u, gradient, slope[q]);
  }
  [[gnu::always_inline]] static inline void transposed_gradient(const ElementPacks& packs,
                                                                const Pack (&flux)[max_points][3][3],
                                                                NodePacks<n_nodes>& f) {
    const double* gradient = packs.natural_gradient.data();
    std::memset(&f, 0, sizeof f);
    for (int q = 0; q < packs.n_points; ++q, gradient += 3 * n_nodes) add_flux_at_point<n_nodes>(flux[q], gradient, f);
  }
};

}  // namespace couplet::solid
