#include "solid-server/service/make_setup.hpp"

#include <algorithm>
#include <thread>

#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/make_time_table.hpp"
#include "solid-server/mesh/box_mesh.hpp"
#include "solid-server/mesh/vocal_fold_mesh.hpp"

namespace couplet::solid {

namespace {

SolidMesh make_fold(const v1::VocalFoldMesh& fold) {
  VocalFoldShape shape;
  shape.section.medial_thickness = fold.medial_thickness();
  shape.section.width = fold.width();
  shape.section.depth = fold.depth();
  shape.section.superior_lean = fold.superior_lean();
  shape.section.inferior_bulge = fold.inferior_bulge();
  shape.section.inferior_fillet = fold.inferior_fillet();
  shape.section.superior_fillet = fold.superior_fillet();
  shape.length = fold.length();
  shape.x_offset = fold.x_offset();
  shape.n_elements = {fold.elements_x(), fold.elements_y(), fold.elements_z()};
  shape.half_length = fold.half_length();
  return make_vocal_fold_mesh(shape);
}

SolidMesh make_box(const v1::BoxMesh& box) {
  return make_box_mesh(
      {{box.length().x(), box.length().y(), box.length().z()}, {box.elements_x(), box.elements_y(), box.elements_z()}});
}

SolidMesh make_mesh(const v1::Body& body) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold:
      return make_fold(body.vocal_fold());
    case v1::Body::kBox:
      return make_box(body.box());
    case v1::Body::MESH_NOT_SET:
      break;
  }
  throw report::SceneError("solid.body[0]", "the body has no mesh", "give vocal_fold or box");
}

Material make_material(const v1::Material& material) {
  switch (material.law_case()) {
    case v1::Material::kSaintVenantKirchhoff:
      return SaintVenantKirchhoff::from_young(material.saint_venant_kirchhoff().young_modulus(),
                                              material.saint_venant_kirchhoff().poisson_ratio());
    case v1::Material::kMooneyRivlin:
      return MooneyRivlin{material.mooney_rivlin().a10(), material.mooney_rivlin().a01(),
                          material.mooney_rivlin().bulk_modulus()};
    case v1::Material::LAW_NOT_SET:
      break;
  }
  throw report::SceneError("solid.body[0].material", "the material has no law",
                           "give saint_venant_kirchhoff or mooney_rivlin");
}

Supports make_supports(const v1::Body& body) {
  Supports supports;
  supports.fixed.assign(body.fixed().begin(), body.fixed().end());
  for (const v1::Symmetry& symmetry : body.symmetry())
    supports.symmetry.push_back({symmetry.surface(), symmetry.normal() - v1::Symmetry::X});
  return supports;
}

Kick make_kick(const v1::Kick& kick) {
  const auto x = std::make_shared<scene::Expression>(kick.velocity().x());
  const auto y = std::make_shared<scene::Expression>(kick.velocity().y());
  const auto z = std::make_shared<scene::Expression>(kick.velocity().z());
  return {kick.time(), [=, t = kick.time()](const Eigen::Vector3d& p) {
            const auto at = [&](const scene::Expression& formula) { return formula.at(p.x(), p.y(), p.z(), t); };
            return Eigen::Vector3d(at(*x), at(*y), at(*z));
          }};
}

PressureLoad make_pressure(const v1::PressureLoad& load) {
  return {load.surface(), [table = scene::make_time_table(load.value())](double time) { return table.at(time); }};
}

}  // namespace

SolidSetup make_setup(const v1::Solid& solid) {
  if (solid.body_size() != 1)
    throw report::SceneError("solid.body", std::to_string(solid.body_size()) + " bodies", "give one body");
  const v1::Body& body = solid.body(0);
  SolidSetup setup;
  setup.mesh = make_mesh(body);
  setup.properties = {{make_material(body.material()), body.material().density(), body.points_per_element()}};
  setup.supports = make_supports(body);
  setup.wetted.assign(body.wetted().begin(), body.wetted().end());
  setup.damping = {body.mass_damping(), solid.settling().until(), solid.settling().mass_damping()};
  setup.damping.stiffness_factor = body.stiffness_damping();
  for (const v1::Kick& kick : solid.kick()) setup.kicks.push_back(make_kick(kick));
  for (const v1::PressureLoad& load : solid.pressure()) setup.pressures.push_back(make_pressure(load));
  for (const v1::RigidPlane& plane : solid.rigid_plane()) setup.planes.push_back({plane.y(), plane.stiffness()});
  setup.step.safety = solid.time_integration().safety();
  setup.step.largest_substep = solid.time_integration().largest_substep();
  setup.step.estimate_every = solid.time_integration().estimate_every();
  return setup;
}

int worthwhile_threads(int wanted, Index n_elements) {
  // Below this a barrier and the wake-up of a thread cost more than a further thread saves.
  constexpr Index elements_per_thread = 500;
  const int offered = wanted > 0 ? wanted : static_cast<int>(std::thread::hardware_concurrency());
  return std::clamp(static_cast<int>(n_elements / elements_per_thread), 1, std::max(1, offered));
}

}  // namespace couplet::solid
