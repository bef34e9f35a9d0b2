// Rules about what acts on a body: directions, motions, supports.

#include <algorithm>

#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

bool is_zero(const v1::Vector& vector) {
  return vector.x() == 0 && vector.y() == 0 && vector.z() == 0;
}

/// A direction without length would take its load out of the scene in silence.
void directions_have_a_length(const v1::Solid& solid, Review& review) {
  const auto check = [&](bool is_given, const v1::Vector& direction, const std::string& path) {
    if (!is_given || !is_zero(direction)) return;
    review.complain(path, "all components are 0; give a direction, for example { x: 1 }");
  };
  for (int i = 0; i < solid.traction_size(); ++i)
    check(solid.traction(i).value().has_direction(), solid.traction(i).value().direction(),
          entry("solid.traction", i) + ".value.direction");
  for (int i = 0; i < solid.node_force_size(); ++i)
    check(solid.node_force(i).value().has_direction(), solid.node_force(i).value().direction(),
          entry("solid.node_force", i) + ".value.direction");
  check(solid.gravity().has_direction(), solid.gravity().direction(), "solid.gravity.direction");
  for (int i = 0; i < solid.rigid_plane_size(); ++i)
    check(solid.rigid_plane(i).plane().has_normal(), solid.rigid_plane(i).plane().normal(),
          entry("solid.rigid_plane", i) + ".plane.normal");
  for (int b = 0; b < solid.body_size(); ++b) {
    const v1::CircumferentialFibres& around = solid.body(b).fibres().circumferential();
    check(around.has_axis(), around.axis(), entry("solid.body", b) + ".fibres.circumferential.axis");
  }
}

void motions_have_components(const v1::Solid& solid, Review& review) {
  for (int i = 0; i < solid.prescribed_motion_size(); ++i) {
    const v1::PrescribedMotion& motion = solid.prescribed_motion(i);
    if (motion.has_x() || motion.has_y() || motion.has_z()) continue;
    review.complain(entry("solid.prescribed_motion", i), "has no component; give x, y or z, or delete it");
  }
}

bool is_held(const v1::Solid& solid, const v1::Body& body) {
  const std::string prefix = solid.body_size() > 1 ? body.name() + "/" : "";
  const auto moves = [&](const v1::PrescribedMotion& motion) { return motion.nodes().starts_with(prefix); };
  return body.fixed_size() > 0 || body.symmetry_size() > 0 ||
         std::any_of(solid.prescribed_motion().begin(), solid.prescribed_motion().end(), moves);
}

bool may_touch(const v1::Solid& solid) {
  return solid.contact_size() > 0 || solid.rigid_plane_size() > 0;
}

/// Without inertia nothing but supports and contact keeps a body in its place, and a velocity means nothing.
void equilibrium_is_possible(const v1::Solid& solid, Review& review) {
  if (solid.time_integration().method() != v1::TimeIntegration::STATIC) return;
  for (int b = 0; b < solid.body_size(); ++b)
    if (!is_held(solid, solid.body(b)) && !may_touch(solid))
      review.complain(entry("solid.body", b),
                      "nothing holds the body, so that it has no equilibrium; give fixed, symmetry or "
                      "prescribed_motion, or another time_integration.method than STATIC");
  for (int k = 0; k < solid.kick_size(); ++k)
    review.complain(entry("solid.kick", k),
                    "an equilibrium has no velocities; delete it, or give another time_integration.method than STATIC");
}

}  // namespace

void check_solid_load_rules(const v1::Scene& scene, Review& review) {
  directions_have_a_length(scene.solid(), review);
  motions_have_components(scene.solid(), review);
  equilibrium_is_possible(scene.solid(), review);
}

}  // namespace couplet::scene
