#include "solid-server/mesh/parametric/hollow_sphere_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/merge_patches.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

void check_shape(const HollowSphereShape& shape) {
  if (!(shape.inner_radius > 0 && shape.outer_radius > shape.inner_radius))
    throw report::SceneError("hollow_sphere", "inner_radius of " + report::text(shape.inner_radius) +
                                                  " m is not between 0 and outer_radius of " +
                                                  report::text(shape.outer_radius) + " m");
  if (shape.n_radial < 1 || shape.n_around < 1)
    throw report::SceneError("hollow_sphere",
                             std::to_string(std::min(shape.n_radial, shape.n_around)) + " elements are not above 0");
}

}  // namespace

SolidMesh make_hollow_sphere_mesh(const HollowSphereShape& shape) {
  check_shape(shape);
  const int n = shape.n_around, n_radial = shape.n_radial;
  const StructuredBlock block(n, n, n_radial);
  std::vector<SolidMesh> patches;
  for (const Eigen::Index axis : {0, 1, 2}) {  // the patch around this axis; first and second follow it cyclically
    const Eigen::Index first = (axis + 1) % 3, second = (axis + 2) % 3;
    SolidMesh patch = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
      Eigen::Vector3d direction;
      direction[axis] = 1;
      direction[first] = std::tan(std::numbers::pi / 4 * place.i / (2.0 * n));
      direction[second] = std::tan(std::numbers::pi / 4 * place.j / (2.0 * n));
      const double radius = shape.inner_radius + (shape.outer_radius - shape.inner_radius) * place.k / (2.0 * n_radial);
      return radius * direction.normalized();
    });
    const std::array<const char*, 3> plane = {"x_min", "y_min", "z_min"};
    patch.surface = {{"inner", block.side(hex20::zeta_min)},
                     {"outer", block.side(hex20::zeta_max)},
                     {plane[static_cast<std::size_t>(first)], block.side(hex20::xi_min)},
                     {plane[static_cast<std::size_t>(second)], block.side(hex20::eta_min)}};
    patches.push_back(std::move(patch));
  }
  return merge_patches(patches);
}

}  // namespace couplet::solid
