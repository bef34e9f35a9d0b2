#include "solid-server/service/make_setup.hpp"

#include <algorithm>
#include <thread>

#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/make_time_table.hpp"
#include "solid-server/assembly/machine_memory.hpp"
#include "solid-server/mesh/fibre_rule.hpp"
#include "solid-server/mesh/find_overlap.hpp"
#include "solid-server/service/make_material.hpp"
#include "solid-server/service/make_mesh.hpp"
#include "solid-server/service/mesh_size.hpp"

namespace couplet::solid {

namespace {

std::string entry(const std::string& list, int index) {
  return list + "[" + std::to_string(index) + "]";
}

Eigen::Vector3d vector(const v1::Vector& v) {
  return {v.x(), v.y(), v.z()};
}

VectorOverTime make_vector(const v1::VectorTable& table) {
  return [direction = vector(table.direction()), value = scene::make_time_table(table.value())](double time) {
    return Eigen::Vector3d(value.at(time) * direction);
  };
}

ElementFormulation formulation_of(const v1::Body& body, ElementShape shape) {
  const bool can_average = shape != ElementShape::hexahedron8;  // which is stabilised, and does not lock
  return body.near_incompressible() && can_average ? ElementFormulation::near_incompressible
                                                   : default_formulation(shape);
}

int n_points_of(const v1::Body& body, const SolidMesh& mesh, const ElementBlock& block,
                ElementFormulation formulation) {
  if (body.has_points_per_element() && block.shape == ElementShape::hexahedron20) return body.points_per_element();
  return default_n_points(mesh, block, formulation);
}

/// What each block of a body is made of: the material of its region, or that of the body.
std::vector<BlockProperties> make_properties(const v1::Body& body, const SolidMesh& mesh, const std::string& where) {
  std::vector<BlockProperties> properties;
  for (const ElementBlock& block : mesh.block) {
    const auto region = std::find_if(body.region().begin(), body.region().end(),
                                     [&](const v1::Region& r) { return r.name() == block.region; });
    const bool has_own = region != body.region().end();
    if (!has_own && !body.has_material())
      throw report::SceneError(where, "the region \"" + block.region + "\" of the mesh has no material",
                               "give region { name: \"" + block.region + "\" ... }, or material for all other regions");
    const v1::Material& material = has_own ? region->material() : body.material();
    const std::string place =
        has_own ? entry(where + ".region", static_cast<int>(region - body.region().begin())) : where;
    const ElementFormulation formulation = formulation_of(body, block.shape);
    properties.push_back({make_material(material, place + ".material"), material.density(),
                          n_points_of(body, mesh, block, formulation), formulation});
    check_formulation(place + ".material", block.shape, formulation, properties.back().material);
  }
  for (int r = 0; r < body.region_size(); ++r) {
    const std::string& name = body.region(r).name();
    if (std::none_of(mesh.block.begin(), mesh.block.end(), [&](const auto& block) { return block.region == name; }))
      throw report::SceneError(entry(where + ".region", r) + ".name", "the mesh has no region \"" + name + "\"",
                               "name one of its regions");
  }
  return properties;
}

/// Directions of fibres for the blocks of a body: those of the region, of the body, or of the mesh. Throws SceneError
/// where a law needs some and there are none.
void set_fibres(const v1::Body& body, const std::string& where, const std::vector<BlockProperties>& properties,
                SolidMesh& mesh) {
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    ElementBlock& block = mesh.block[b];
    const auto region = std::find_if(body.region().begin(), body.region().end(),
                                     [&](const v1::Region& r) { return r.name() == block.region && r.has_fibres(); });
    const bool is_own = region != body.region().end();
    const v1::Fibres& fibres = is_own ? region->fibres() : body.fibres();
    const std::string place =
        (is_own ? entry(where + ".region", static_cast<int>(region - body.region().begin())) : where) + ".fibres";
    if (const auto rule = make_fibre_rule(fibres)) block.axes = axes_by_rule(*rule, mesh, block, place);
    const bool needs_fibres = std::visit([](const auto& law) { return law.is_anisotropic; }, properties[b].material);
    if (needs_fibres && block.axes.empty())
      throw report::SceneError(
          place, "the law of region \"" + block.region + "\" has fibres, but the mesh gives no directions",
          "give constant or circumferential, or element data \"fibre\" in a Gmsh file");
    if (!needs_fibres) block.axes.clear();
  }
}

/// Adds what a body names for itself; with several bodies, under their own names. Throws SceneError for names that its
/// mesh does not have.
void add_body(const v1::Body& body, const std::string& where, const SolidMesh& mesh, const std::string& prefix,
              SolidSetup& setup) {
  for (int n = 0; n < body.fixed_size(); ++n) {
    mesh.find_nodes(body.fixed(n), entry(where + ".fixed", n));
    setup.supports.fixed.push_back(prefix + body.fixed(n));
  }
  for (int n = 0; n < body.symmetry_size(); ++n) {
    const v1::Symmetry& symmetry = body.symmetry(n);
    mesh.find_nodes(symmetry.surface(), entry(where + ".symmetry", n) + ".surface");
    setup.supports.symmetry.push_back({prefix + symmetry.surface(), symmetry.normal() - v1::Symmetry::X});
  }
  for (int n = 0; n < body.wetted_size(); ++n) {
    mesh.find_surface(body.wetted(n), entry(where + ".wetted", n));
    setup.wetted.push_back(prefix + body.wetted(n));
  }
}

void refuse_different_damping(const v1::Solid& solid) {
  for (int b = 1; b < solid.body_size(); ++b)
    if (solid.body(b).mass_damping() != solid.body(0).mass_damping() ||
        solid.body(b).stiffness_damping() != solid.body(0).stiffness_damping())
      throw report::SceneError(entry("solid.body", b), "the damping differs from that of the first body",
                               "give all bodies the same mass_damping and stiffness_damping");
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

RigidPlane make_plane(const v1::RigidPlane& plane) {
  RigidPlane out{{0, plane.y(), 0}, -Eigen::Vector3d::UnitY(), plane.stiffness(), {}};
  if (plane.has_plane()) {
    out.point = vector(plane.plane().point());
    out.normal = vector(plane.plane().normal());
  }
  out.surfaces.assign(plane.surface().begin(), plane.surface().end());
  return out;
}

ContactPair make_contact(const v1::Contact& contact) {
  ContactPair pair;
  pair.first = contact.first();
  pair.second = contact.second();
  pair.stiffness = contact.stiffness();  // absent: 0, from the elements
  pair.distance = contact.distance();
  pair.cancels_interface_load = contact.cancel_interface_load();
  return pair;
}

/// What overlaps at rest feels no contact: a point deep behind a face has nothing to do with it.
void refuse_overlap_at_rest(const v1::Solid& solid, const SolidMesh& mesh) {
  for (int c = 0; c < solid.contact_size(); ++c) {
    const v1::Contact& contact = solid.contact(c);
    const std::string where = entry("solid.contact", c),
                      &second = contact.has_second() ? contact.second() : contact.first();
    const auto& faces = mesh.find_surface(contact.first(), where + ".first");
    const auto& others = mesh.find_surface(second, where + (contact.has_second() ? ".second" : ".first"));
    auto found = find_overlap(mesh, faces, others);
    if (!found) found = find_overlap(mesh, others, faces);
    if (found)
      throw report::SceneError(where,
                               "the bodies overlap at rest: the node at " +
                                   place_text(mesh.node_position.row(found->node)) + " is inside " +
                                   mesh.describe_element(found->element),
                               "move one of them, for example by its placement");
  }
}

void add_loads(const v1::Solid& solid, SolidSetup& setup) {
  for (const v1::PressureLoad& load : solid.pressure()) setup.pressures.push_back(make_pressure(load));
  for (const v1::TractionLoad& load : solid.traction())
    setup.tractions.push_back({load.surface(), make_vector(load.value())});
  for (const v1::NodeForceLoad& load : solid.node_force())
    setup.node_forces.push_back({load.nodes(), make_vector(load.value())});
  if (solid.has_gravity()) setup.gravity = make_vector(solid.gravity());
}

void add_prescribed_motion(const v1::PrescribedMotion& motion, Supports& supports) {
  const auto add = [&](bool is_given, const std::string& formula, int axis) {
    if (!is_given) return;
    const auto parsed = std::make_shared<scene::Expression>(formula);
    supports.prescribed.push_back({motion.nodes(), axis, [parsed](const Eigen::Vector3d& p, double time) {
                                     return parsed->at(p.x(), p.y(), p.z(), time);
                                   }});
  };
  add(motion.has_x(), motion.x(), 0);
  add(motion.has_y(), motion.y(), 1);
  add(motion.has_z(), motion.z(), 2);
}

/// AUTO begins as the central difference method; whoever opens the scene chooses.
TimeMethod time_method(v1::TimeIntegration::Method method) {
  switch (method) {
    case v1::TimeIntegration::GENERALIZED_ALPHA:
      return TimeMethod::generalized_alpha;
    case v1::TimeIntegration::STATIC:
      return TimeMethod::static_equilibrium;
    case v1::TimeIntegration::CENTRAL_DIFFERENCE:
    case v1::TimeIntegration::AUTO:
      break;
  }
  return TimeMethod::central_difference;
}

void set_time_integration(const v1::TimeIntegration& given, SolidSetup& setup) {
  setup.method = time_method(given.method());
  setup.step = {given.safety(), given.largest_substep(), given.estimate_every()};
  setup.implicit.spectral_radius = given.spectral_radius();
  setup.implicit.largest_substep = given.largest_substep();
  setup.implicit.newton = {given.newton_tolerance(), given.newton_iterations_max()};
  setup.statics.newton = setup.implicit.newton;
  setup.statics.path.tolerance = given.newton_tolerance();
  setup.statics.may_follow_path = given.arc_length();
}

}  // namespace

SolidSetup make_setup(const v1::Solid& solid, const std::filesystem::path& scene_folder) {
  refuse_different_damping(solid);
  refuse_too_many_elements(solid, machine_memory());
  SolidSetup setup;
  std::vector<SolidMesh> meshes;
  std::vector<std::string> names;
  for (int b = 0; b < solid.body_size(); ++b) {
    const v1::Body& body = solid.body(b);
    const std::string where = entry("solid.body", b);
    meshes.push_back(make_mesh(body, where, scene_folder));
    names.push_back(body.name());
    const auto properties = make_properties(body, meshes.back(), where);
    set_fibres(body, where, properties, meshes.back());
    setup.properties.insert(setup.properties.end(), properties.begin(), properties.end());
    add_body(body, where, meshes.back(), solid.body_size() > 1 ? body.name() + "/" : "", setup);
  }
  setup.mesh = join_bodies(std::move(meshes), names);
  refuse_overlap_at_rest(solid, setup.mesh);
  add_loads(solid, setup);
  setup.damping = {solid.body(0).mass_damping(), solid.settling().until(), solid.settling().mass_damping()};
  setup.damping.stiffness_factor = solid.body(0).stiffness_damping();
  for (const v1::Kick& kick : solid.kick()) setup.kicks.push_back(make_kick(kick));
  for (const v1::RigidPlane& plane : solid.rigid_plane()) setup.planes.push_back(make_plane(plane));
  for (const v1::Contact& contact : solid.contact()) setup.contacts.push_back(make_contact(contact));
  for (const v1::PrescribedMotion& motion : solid.prescribed_motion()) add_prescribed_motion(motion, setup.supports);
  set_time_integration(solid.time_integration(), setup);
  setup.keeps_energy_balance = solid.energy_balance();
  return setup;
}

OrificeShape make_orifice_shape(const v1::Orifice& orifice) {
  return {orifice.name(),
          {orifice.surface().begin(), orifice.surface().end()},
          orifice.axis() - v1::Symmetry::X,
          vector(orifice.centre()),
          orifice.radius(),
          orifice.cells()};
}

int worthwhile_threads(int wanted, const SolidSetup& setup) {
  // Below this a barrier and the wake-up of a thread cost more than a further thread saves.
  constexpr std::int64_t points_per_thread = 4000;
  std::int64_t n_points = 0;
  for (std::size_t b = 0; b < setup.mesh.block.size(); ++b)
    n_points += std::int64_t{setup.mesh.block[b].n_elements()} * setup.properties[b].n_points;
  const int offered = std::max(1, wanted > 0 ? wanted : static_cast<int>(std::thread::hardware_concurrency()));
  return static_cast<int>(std::clamp<std::int64_t>(n_points / points_per_thread, 1, offered));
}

}  // namespace couplet::solid
