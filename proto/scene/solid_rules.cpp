#include <cmath>
#include <numbers>
#include <set>

#include "proto/scene/mesh_names.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

void name_exists(const std::string& name, const std::string& kind, const std::vector<std::string>& known,
                 const std::string& path, Review& review) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  review.complain(path, "the mesh has no " + kind + " \"" + name + "\"; " +
                            (known.empty() ? "it names none" : suggestion(name, known, "it has")));
}

/// What a body's own fields may name; nothing is checked where only the mesh file knows.
struct KnownNames {
  std::vector<std::string> surfaces, sets, nodes;  // sets: surfaces and node sets; nodes: markers too
  bool are_unknown = false;
};

KnownNames names_of(const v1::Body& body) {
  const auto joined = [](std::vector<std::string> names, const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
    return names;
  };
  KnownNames names{surface_names(body), joined(surface_names(body), node_set_names(body)), {}, has_own_names(body)};
  names.nodes = joined(names.sets, marker_names(body));
  return names;
}

/// What fields outside the bodies may name: BODY/NAME with several bodies.
KnownNames names_of(const v1::Solid& solid) {
  if (solid.body_size() == 1) return names_of(solid.body(0));
  KnownNames all;
  for (const v1::Body& body : solid.body()) {
    const KnownNames own = names_of(body);
    all.are_unknown = all.are_unknown || own.are_unknown;
    for (const std::string& name : own.surfaces) all.surfaces.push_back(body.name() + "/" + name);
    for (const std::string& name : own.nodes) all.nodes.push_back(body.name() + "/" + name);
  }
  return all;
}

void surfaces_exist(const v1::Body& body, const std::string& path, Review& review) {
  const KnownNames known = names_of(body);
  if (known.are_unknown) return;
  for (int i = 0; i < body.fixed_size(); ++i)
    name_exists(body.fixed(i), "surface", known.sets, entry(path + ".fixed", i), review);
  for (int i = 0; i < body.wetted_size(); ++i)
    name_exists(body.wetted(i), "surface", known.surfaces, entry(path + ".wetted", i), review);
  for (int i = 0; i < body.symmetry_size(); ++i)
    if (body.symmetry(i).has_surface())
      name_exists(body.symmetry(i).surface(), "surface", known.sets, entry(path + ".symmetry", i) + ".surface", review);
}

void loaded_names_exist(const v1::Solid& solid, Review& review) {
  const KnownNames known = names_of(solid);
  if (known.are_unknown) return;
  const auto surface = [&](bool is_given, const std::string& name, const std::string& path) {
    if (is_given) name_exists(name, "surface", known.surfaces, path, review);
  };
  const auto nodes = [&](bool is_given, const std::string& name, const std::string& path) {
    if (is_given) name_exists(name, "surface, node set or marker", known.nodes, path, review);
  };
  for (int i = 0; i < solid.pressure_size(); ++i)
    surface(solid.pressure(i).has_surface(), solid.pressure(i).surface(), entry("solid.pressure", i) + ".surface");
  for (int i = 0; i < solid.traction_size(); ++i)
    surface(solid.traction(i).has_surface(), solid.traction(i).surface(), entry("solid.traction", i) + ".surface");
  for (int i = 0; i < solid.contact_size(); ++i) {
    surface(solid.contact(i).has_first(), solid.contact(i).first(), entry("solid.contact", i) + ".first");
    surface(solid.contact(i).has_second(), solid.contact(i).second(), entry("solid.contact", i) + ".second");
  }
  for (int i = 0; i < solid.rigid_plane_size(); ++i)
    for (int j = 0; j < solid.rigid_plane(i).surface_size(); ++j)
      surface(true, solid.rigid_plane(i).surface(j), entry(entry("solid.rigid_plane", i) + ".surface", j));
  for (int i = 0; i < solid.orifice_size(); ++i)
    for (int j = 0; j < solid.orifice(i).surface_size(); ++j)
      surface(true, solid.orifice(i).surface(j), entry(entry("solid.orifice", i) + ".surface", j));
  for (int i = 0; i < solid.node_force_size(); ++i)
    nodes(solid.node_force(i).has_nodes(), solid.node_force(i).nodes(), entry("solid.node_force", i) + ".nodes");
  for (int i = 0; i < solid.prescribed_motion_size(); ++i)
    nodes(solid.prescribed_motion(i).has_nodes(), solid.prescribed_motion(i).nodes(),
          entry("solid.prescribed_motion", i) + ".nodes");
}

/// Two entries for the same two surfaces would push twice.
void contacts_differ(const v1::Solid& solid, Review& review) {
  const auto surfaces = [](const v1::Contact& contact) {
    return std::minmax(contact.first(), contact.has_second() ? contact.second() : contact.first());
  };
  for (int i = 1; i < solid.contact_size(); ++i)
    for (int j = 0; j < i; ++j)
      if (surfaces(solid.contact(i)) == surfaces(solid.contact(j)))
        review.complain(entry("solid.contact", i), "names the surfaces of solid.contact[" + std::to_string(j) +
                                                       "] again; give one contact, with the stiffness that is wanted");
}

void regions_exist(const v1::Body& body, const std::string& path, Review& review) {
  if (!body.has_material() && body.region_size() == 0)
    review.complain_missing(path + ".material", "is missing; give what the body is made of");
  if (has_own_names(body)) return;
  const std::vector<std::string> known = region_names(body);
  for (int i = 0; i < body.region_size(); ++i)
    if (body.region(i).has_name())
      name_exists(body.region(i).name(), "region", known, entry(path + ".region", i) + ".name", review);
}

/// Laws with fibres know what they need, near-incompressible elements too.
void material_fits(const v1::Material& material, const std::string& path, bool has_fibres, bool is_averaged,
                   Review& review) {
  const bool needs_fibres = material.has_holzapfel_gasser_ogden() || material.has_may_newman();
  if (needs_fibres && !has_fibres)
    review.complain(path, "the law has fibres, but the body does not say where they run; give fibres { ... }");
  if (is_averaged && material.has_saint_venant_kirchhoff())
    review.complain(path + ".saint_venant_kirchhoff",
                    "has no volumetric part that near_incompressible could average; use neo_hookean or mooney_rivlin");
}

void materials_fit(const v1::Body& body, const std::string& path, Review& review) {
  const bool has_fibres = body.has_fibres() || body.has_valve();
  if (body.has_material())
    material_fits(body.material(), path + ".material", has_fibres, body.near_incompressible(), review);
  for (int i = 0; i < body.region_size(); ++i)
    material_fits(body.region(i).material(), entry(path + ".region", i) + ".material",
                  has_fibres || body.region(i).has_fibres(), body.near_incompressible(), review);
}

void body_names_differ(const v1::Solid& solid, Review& review) {
  std::set<std::string> names;
  for (int i = 0; i < solid.body_size(); ++i) {
    if (!solid.body(i).has_name() || names.insert(solid.body(i).name()).second) continue;
    review.complain(entry("solid.body", i) + ".name",
                    "\"" + solid.body(i).name() + "\" is the name of another body; give each its own name");
  }
}

void quadrature_exists(const v1::Body& body, const std::string& path, Review& review) {
  const int n_points = body.points_per_element();
  const bool is_within_limits = n_points >= 8 && n_points <= 27;
  if (!body.has_points_per_element() || !is_within_limits || n_points == 8 || n_points == 14 || n_points == 27) return;
  review.complain(path + ".points_per_element", std::to_string(n_points) + " is not 8, 14 or 27; choose 8, 14 or 27");
}

void wall_has_a_thickness(const v1::Body& body, const std::string& path, Review& review) {
  const auto check = [&](const auto& mesh, const std::string& name) {
    if (!mesh.has_inner_radius() || !mesh.has_outer_radius() || mesh.inner_radius() < mesh.outer_radius()) return;
    review.complain(path + "." + name + ".outer_radius",
                    number_text(mesh.outer_radius()) + " m is not above the inner radius, " +
                        number_text(mesh.inner_radius()) + " m; give a larger one");
  };
  if (body.has_annulus()) check(body.annulus(), "annulus");
  if (body.has_hollow_sphere()) check(body.hollow_sphere(), "hollow_sphere");
}

void box_has_a_volume(const v1::Body& body, const std::string& path, Review& review) {
  if (!body.box().has_length()) return;
  const v1::Vector& length = body.box().length();
  for (const auto& [name, value] : {std::pair{"x", length.x()}, {"y", length.y()}, {"z", length.z()}})
    if (!(value > 0))
      review.complain(path + ".box.length." + name,
                      number_text(value) + " m is not above 0; give the length of the box along " + name);
}

void half_has_whole_elements(const v1::VocalFoldMesh& fold, const std::string& path, Review& review) {
  if (!fold.half_length() || fold.elements_z() % 2 == 0 || fold.elements_z() < 1) return;
  review.complain(path + ".elements_z", std::to_string(fold.elements_z()) +
                                            " is odd, but half_length keeps half of the elements; give an even number");
}

bool is_within_limits(const v1::VocalFoldMesh& fold) {
  for (const double length : {fold.medial_thickness(), fold.width(), fold.depth(), fold.length(),
                              fold.inferior_fillet(), fold.superior_fillet(), fold.inferior_bulge()}) {
    if (!(length > 0) || !std::isfinite(length)) return false;
  }
  return fold.superior_lean() >= 0 && fold.superior_lean() < 45;
}

// Four digits, rounded down: what is written is allowed.
std::string room_text(double length) {
  const double unit = std::pow(10, std::floor(std::log10(length)) - 3);
  return number_text(std::floor(length / unit) * unit);
}

// The section along the flow: inferior face, T, tangent length r_s tan((90 deg - lean)/2) of the superior fillet, and
// the lean D tan(lean) of the superior face must fit into the width W.
void section_exists(const v1::VocalFoldMesh& fold, const std::string& path, Review& review) {
  if (!fold.has_medial_thickness() || !is_within_limits(fold)) return;
  for (const char* const name : {"inferior_fillet", "superior_fillet"}) {
    const double radius = name[0] == 'i' ? fold.inferior_fillet() : fold.superior_fillet();
    if (radius < fold.depth()) continue;
    review.complain(path + "." + name, number_text(radius) + " m is not smaller than the depth of the fold, " +
                                           number_text(fold.depth()) + " m; give a smaller radius");
    return;
  }
  const double lean = fold.superior_lean() * std::numbers::pi / 180;
  const double fillet = fold.superior_fillet() * std::tan((std::numbers::pi / 2 - lean) / 2);
  const double room = fold.width() - fold.depth() * std::tan(lean) - fillet;
  if (fold.medial_thickness() < room) return;
  review.complain(path + ".medial_thickness",
                  number_text(fold.medial_thickness()) + " m leaves no inferior face in a fold of width " +
                      number_text(fold.width()) + " m; " +
                      (room > 0 ? "give less than " + room_text(room) + " m or a larger width"
                                : "give a larger width or less lean"));
}

}  // namespace

void check_solid_rules(const v1::Scene& scene, Review& review) {
  const v1::Solid& solid = scene.solid();
  for (int i = 0; i < solid.body_size(); ++i) {
    const v1::Body& body = solid.body(i);
    const std::string path = entry("solid.body", i);
    surfaces_exist(body, path, review);
    quadrature_exists(body, path, review);
    regions_exist(body, path, review);
    materials_fit(body, path, review);
    wall_has_a_thickness(body, path, review);
    box_has_a_volume(body, path, review);
    if (!body.has_vocal_fold()) continue;
    half_has_whole_elements(body.vocal_fold(), path + ".vocal_fold", review);
    section_exists(body.vocal_fold(), path + ".vocal_fold", review);
  }
  loaded_names_exist(solid, review);
  contacts_differ(solid, review);
  body_names_differ(solid, review);
}

}  // namespace couplet::scene
