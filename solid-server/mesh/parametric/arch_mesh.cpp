#include "solid-server/mesh/parametric/arch_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

void check_shape(const ArchShape& shape) {
  const auto refuse = [](const std::string& sentence, const std::string& advice = {}) {
    throw report::SceneError("arch", sentence, advice);
  };
  for (const auto& [name, value] : {std::pair{"span", shape.span}, std::pair{"rise", shape.rise},
                                    std::pair{"thickness", shape.thickness}, std::pair{"width", shape.width}})
    if (!(value > 0)) refuse(std::string(name) + " of " + report::text(value) + " m is not above 0");
  const double curvature =
      shape.rise * std::numbers::pi * std::numbers::pi / (shape.span * shape.span);  // at the crown
  if (shape.thickness / 2 * curvature >= 1)
    refuse("thickness of " + report::text(shape.thickness) + " m is not below twice the radius of the crown, " +
               report::text(2 / curvature) + " m",
           "choose a thinner or flatter arch");
  for (const int n : shape.n_elements)
    if (n < 1) refuse("a number of elements of " + std::to_string(n) + " is not above 0");
}

}  // namespace

SolidMesh make_arch_mesh(const ArchShape& shape) {
  check_shape(shape);
  const auto& n = shape.n_elements;
  const StructuredBlock block(n[0], n[1], n[2]);
  SolidMesh mesh = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
    const double phase = std::numbers::pi * place.i / (2.0 * n[0]);
    const double slope = shape.rise * std::numbers::pi / shape.span * std::cos(phase);
    const double s = shape.thickness * (place.j / (2.0 * n[1]) - 0.5);
    const Eigen::Vector2d normal = Eigen::Vector2d(-slope, 1).normalized();
    return {shape.span * place.i / (2.0 * n[0]) + s * normal.x(), shape.rise * std::sin(phase) + s * normal.y(),
            shape.width * place.k / (2.0 * n[2])};
  });
  mesh.surface = {{"left", block.side(hex20::xi_min)},    {"right", block.side(hex20::xi_max)},
                  {"bottom", block.side(hex20::eta_min)}, {"top", block.side(hex20::eta_max)},
                  {"back", block.side(hex20::zeta_min)},  {"front", block.side(hex20::zeta_max)}};
  for (const auto& [name, i] : {std::pair{"left_hinge", 0}, std::pair{"right_hinge", 2 * n[0]}}) {
    auto& nodes = mesh.node_set[name];
    for (int k = 0; k <= 2 * n[2]; ++k)
      if (const Index node = block.node_at({i, n[1], k}); node >= 0) nodes.push_back(node);
    std::sort(nodes.begin(), nodes.end());
  }
  mesh.marker["crown"] = block.node_at({n[0], 2 * n[1], 0});
  return mesh;
}

}  // namespace couplet::solid
