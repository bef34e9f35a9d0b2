#include "solid-server/mesh/parametric/annulus_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/merge_patches.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

constexpr double whole_turn = 2 * std::numbers::pi;
constexpr double rounding = 1e-9;  // of angles that were given in degrees [rad]

void check_shape(const AnnulusShape& shape) {
  const auto refuse = [](const std::string& sentence, const std::string& advice = {}) {
    throw report::SceneError("annulus", sentence, advice);
  };
  if (!(shape.inner_radius > 0 && shape.outer_radius > shape.inner_radius))
    refuse("inner_radius of " + report::text(shape.inner_radius) + " m is not between 0 and outer_radius of " +
           report::text(shape.outer_radius) + " m");
  if (!(shape.length > 0)) refuse("length of " + report::text(shape.length) + " m is not above 0");
  if (!(shape.angle > 0 && shape.angle <= whole_turn + rounding))
    refuse("angle of " + report::text(shape.angle * 360 / whole_turn) + " degrees is not above 0 and at most 360");
  for (const int n : shape.n_elements)
    if (n < 1) refuse("a number of elements of " + std::to_string(n) + " is not above 0");
  if (shape.angle / shape.n_elements[1] > whole_turn / 4 + rounding)
    refuse(std::to_string(shape.n_elements[1]) + " elements around are too few for " +
               report::text(shape.angle * 360 / whole_turn) + " degrees",
           "give at least one for each quarter turn");
}

}  // namespace

SolidMesh make_annulus_mesh(const AnnulusShape& shape) {
  check_shape(shape);
  const auto& n = shape.n_elements;
  const bool is_closed = shape.angle > whole_turn - rounding;
  const double angle = is_closed ? whole_turn : shape.angle;
  const StructuredBlock block(n[0], n[1], n[2]);
  SolidMesh mesh = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
    const double radius = shape.inner_radius + (shape.outer_radius - shape.inner_radius) * place.i / (2.0 * n[0]);
    const double theta = angle * place.j / (2.0 * n[1]);
    return {radius * std::cos(theta), radius * std::sin(theta), shape.length * place.k / (2.0 * n[2])};
  });
  mesh.surface = {{"inner", block.side(hex20::xi_min)},
                  {"outer", block.side(hex20::xi_max)},
                  {"z_min", block.side(hex20::zeta_min)},
                  {"z_max", block.side(hex20::zeta_max)}};
  if (is_closed) return merge_patches({mesh});
  mesh.surface["start"] = block.side(hex20::eta_min);
  mesh.surface["end"] = block.side(hex20::eta_max);
  return mesh;
}

}  // namespace couplet::solid
