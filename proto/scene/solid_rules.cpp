#include <cmath>
#include <numbers>
#include <set>

#include "proto/scene/mesh_names.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

std::string entry(const std::string& list, int index) {
  return list + "[" + std::to_string(index) + "]";
}

void surface_exists(const std::string& name, const std::vector<std::string>& known, const std::string& path,
                    Review& review) {
  const bool is_unknown = !known.empty() && std::find(known.begin(), known.end(), name) == known.end();
  if (is_unknown) {
    review.complain(path, "the mesh has no surface \"" + name + "\"; " + suggestion(name, known, "it has"));
  }
}

void surfaces_exist(const v1::Body& body, const std::string& path, Review& review) {
  const std::vector<std::string> known = surface_names(body);
  for (int i = 0; i < body.fixed_size(); ++i) {
    surface_exists(body.fixed(i), known, entry(path + ".fixed", i), review);
  }
  for (int i = 0; i < body.wetted_size(); ++i) {
    surface_exists(body.wetted(i), known, entry(path + ".wetted", i), review);
  }
  for (int i = 0; i < body.symmetry_size(); ++i) {
    if (!body.symmetry(i).has_surface()) continue;
    surface_exists(body.symmetry(i).surface(), known, entry(path + ".symmetry", i) + ".surface", review);
  }
}

void loaded_surfaces_exist(const v1::Solid& solid, Review& review) {
  std::vector<std::string> known;
  for (const v1::Body& body : solid.body()) {
    for (const std::string& name : surface_names(body)) known.push_back(name);
  }
  for (int i = 0; i < solid.pressure_size(); ++i) {
    if (!solid.pressure(i).has_surface()) continue;
    surface_exists(solid.pressure(i).surface(), known, entry("solid.pressure", i) + ".surface", review);
  }
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
  if (!is_within_limits || n_points == 8 || n_points == 14 || n_points == 27) return;
  review.complain(path + ".points_per_element", std::to_string(n_points) + " is not 8, 14 or 27; choose 8, 14 or 27");
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
    if (!body.has_vocal_fold()) continue;
    half_has_whole_elements(body.vocal_fold(), path + ".vocal_fold", review);
    section_exists(body.vocal_fold(), path + ".vocal_fold", review);
  }
  loaded_surfaces_exist(solid, review);
  body_names_differ(solid, review);
}

}  // namespace couplet::scene
