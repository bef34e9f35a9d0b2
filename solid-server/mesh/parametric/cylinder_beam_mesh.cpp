#include "solid-server/mesh/parametric/cylinder_beam_mesh.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

void check_shape(const CylinderBeamShape& shape) {
  const auto refuse = [](const std::string& sentence) { throw report::SceneError("cylinder_beam", sentence); };
  for (const auto& [name, value] : {std::pair{"cylinder_radius", shape.cylinder_radius},
                                    std::pair{"length", shape.length}, std::pair{"depth", shape.depth}})
    if (!(value > 0)) refuse(std::string(name) + " of " + report::text(value) + " m is not above 0");
  if (!(shape.height > 0 && shape.height < 2 * shape.cylinder_radius))
    refuse("height of " + report::text(shape.height) + " m is not between 0 and the cylinder's diameter");
  for (const int n : shape.n_elements)
    if (n < 1) refuse("a number of elements of " + std::to_string(n) + " is not above 0");
}

}  // namespace

SolidMesh make_cylinder_beam_mesh(const CylinderBeamShape& shape) {
  check_shape(shape);
  const auto [n_x, n_y, n_z] = shape.n_elements;
  const StructuredBlock block(n_x, n_y, n_z);
  const double radius = shape.cylinder_radius;
  SolidMesh mesh = block.mesh([&, n_x = n_x, n_y = n_y, n_z = n_z](const HalfIndex& place) -> Eigen::Vector3d {
    const double y = shape.height * (place.j / (2.0 * n_y) - 0.5);
    const double root = std::sqrt(radius * radius - y * y);
    const double x = root + (radius + shape.length - root) * place.i / (2.0 * n_x);
    return shape.cylinder_centre + Eigen::Vector3d(x, y, shape.depth * place.k / (2.0 * n_z));
  });
  mesh.surface = {{"root", block.side(hex20::xi_min)},    {"tip", block.side(hex20::xi_max)},
                  {"bottom", block.side(hex20::eta_min)}, {"top", block.side(hex20::eta_max)},
                  {"back", block.side(hex20::zeta_min)},  {"front", block.side(hex20::zeta_max)}};
  mesh.marker["A"] = block.node_at({2 * n_x, n_y, 0});
  return mesh;
}

}  // namespace couplet::solid
