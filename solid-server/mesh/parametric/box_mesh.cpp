#include "solid-server/mesh/parametric/box_mesh.hpp"

#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

SolidMesh make_box_mesh(const BoxShape& shape) {
  const auto& n = shape.n_elements;
  const StructuredBlock block(n[0], n[1], n[2]);
  const auto position = [&](const HalfIndex& place) -> Eigen::Vector3d {
    const Eigen::Vector3d fraction(place.i / (2.0 * n[0]), place.j / (2.0 * n[1]), place.k / (2.0 * n[2]));
    return fraction.cwiseProduct(shape.length);
  };
  SolidMesh mesh = block.mesh(position);
  mesh.surface = {{"x_min", block.side(hex20::xi_min)},   {"x_max", block.side(hex20::xi_max)},
                  {"y_min", block.side(hex20::eta_min)},  {"y_max", block.side(hex20::eta_max)},
                  {"z_min", block.side(hex20::zeta_min)}, {"z_max", block.side(hex20::zeta_max)}};
  return mesh;
}

}  // namespace couplet::solid
