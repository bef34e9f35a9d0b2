// The tangent of the standard formulation.

#include "solid-server/element/tangent_sums.hpp"

namespace couplet::solid {

namespace {

template <int n_element_nodes>
struct StandardElement {
  static constexpr int n_nodes = n_element_nodes;

  template <class Law>
  static PackMask tangent(const ElementPacks& packs, const Law& law, const LocalAxes<Pack>& axes,
                          const StoredPack* geometry, const NodePacks<n_nodes>& u, const Pack (*d)[3],
                          StoredPack* blocks) {
    PackMask is_sound = Pack{} == 0.0;
    PointGroup<n_nodes> group;
    for (int first = 0; first < packs.n_points; first += points_at_once) {
      group.n_points = std::min(points_at_once, packs.n_points - first);
      for (int q = 0; q < group.n_points; ++q) {
        const PointGeometry g = load_geometry(geometry + 10 * (first + q));
        gradient_in_space<n_nodes>(packs, first + q, g, group.gradient[q]);
        const Tensor<Pack> F = deformation_gradient<n_nodes>(u, group.gradient[q]);
        is_sound &= determinant(F, cofactor(F)) > 0.0;
        group.tangent[q] =
            d ? tangent_after(law, F, step_gradient<n_nodes>(d, group.gradient[q], F), axes) : tangent_of(law, F, axes);
        scale(g.volume, group.tangent[q]);
      }
      sum_points(group, first == 0, blocks);
    }
    return is_sound;
  }
};

}  // namespace

Index standard_tangent(const TangentRequest& request, const Material& material) {
  return std::visit(
      [&](const auto& law) {
        switch (request.packs.shape) {
          case ElementShape::tetrahedron10:
            return tangent_of_packs<StandardElement<10>>(request, law);
          case ElementShape::hexahedron8:
            return tangent_of_packs<StandardElement<8>>(request, law);
          case ElementShape::hexahedron20:
            return tangent_of_packs<StandardElement<20>>(request, law);
        }
        __builtin_unreachable();
      },
      material);
}

}  // namespace couplet::solid
