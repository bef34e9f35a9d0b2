#include "solid-server/service/make_mesh.hpp"

#include <cstdio>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/file/read_mesh.hpp"
#include "solid-server/mesh/parametric/annulus_mesh.hpp"
#include "solid-server/mesh/parametric/arch_mesh.hpp"
#include "solid-server/mesh/parametric/ball_mesh.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/mesh/parametric/cylinder_beam_mesh.hpp"
#include "solid-server/mesh/parametric/hollow_sphere_mesh.hpp"
#include "solid-server/mesh/parametric/valve_mesh.hpp"
#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"
#include "solid-server/mesh/place_mesh.hpp"

namespace couplet::solid {

namespace {

Eigen::Vector3d vector_of(const v1::Vector& v) {
  return {v.x(), v.y(), v.z()};
}

SolidMesh make(const v1::VocalFoldMesh& fold) {
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

SolidMesh make(const v1::BoxMesh& box) {
  return make_box_mesh({vector_of(box.length()), {box.elements_x(), box.elements_y(), box.elements_z()}});
}

SolidMesh make(const v1::ValveMesh& valve) {
  ValveShape shape;
  shape.leaflet.tube_radius = valve.tube_radius();
  shape.leaflet.height = valve.height();
  shape.leaflet.opening = valve.opening();
  shape.leaflet.sag = valve.sag();
  shape.leaflet.bulge = valve.bulge();
  shape.thickness = valve.thickness();
  shape.commissure_gap = valve.commissure_gap();
  shape.contact_fraction = valve.contact_fraction();
  shape.n_elements = {valve.elements_u(), valve.elements_v(), valve.elements_t()};
  return make_valve_mesh(shape);
}

SolidMesh make(const v1::CylinderBeamMesh& beam) {
  CylinderBeamShape shape;
  if (beam.has_cylinder_centre()) shape.cylinder_centre = vector_of(beam.cylinder_centre());
  shape.cylinder_radius = beam.cylinder_radius();
  shape.length = beam.length();
  shape.height = beam.thickness();
  shape.depth = beam.width();
  shape.n_elements = {beam.elements_x(), beam.elements_y(), 1};
  return make_cylinder_beam_mesh(shape);
}

SolidMesh make(const v1::AnnulusMesh& annulus) {
  return make_annulus_mesh({annulus.inner_radius(),
                            annulus.outer_radius(),
                            annulus.length(),
                            annulus.angle() * std::numbers::pi / 180,
                            {annulus.elements_radial(), annulus.elements_around(), annulus.elements_along()}});
}

SolidMesh make(const v1::HollowSphereMesh& sphere) {
  return make_hollow_sphere_mesh(
      {sphere.inner_radius(), sphere.outer_radius(), sphere.elements_radial(), sphere.elements_around()});
}

SolidMesh make(const v1::BallMesh& ball) {
  const BallPart part = ball.part() == v1::BallMesh::LOWER_HALF   ? BallPart::lower_half
                        : ball.part() == v1::BallMesh::UPPER_HALF ? BallPart::upper_half
                                                                  : BallPart::whole;
  return make_ball_mesh({ball.radius(), vector_of(ball.centre()), part, ball.quarter(), ball.elements()});
}

SolidMesh make(const v1::ArchMesh& arch) {
  return make_arch_mesh({arch.span(),
                         arch.rise(),
                         arch.thickness(),
                         arch.width(),
                         {arch.elements_x(), arch.elements_y(), arch.elements_z()}});
}

/// Every part of the body must be held where anything of it is: one that is not has nodes that should have been merged.
std::vector<Index> supported_nodes(const v1::Body& body, const SolidMesh& mesh, const std::string& where) {
  std::vector<Index> nodes;
  const auto add = [&](const std::string& name, const std::string& place) {
    const auto found = mesh.find_nodes(name, place);
    nodes.insert(nodes.end(), found.begin(), found.end());
  };
  for (int i = 0; i < body.fixed_size(); ++i) add(body.fixed(i), where + ".fixed[" + std::to_string(i) + "]");
  for (int i = 0; i < body.symmetry_size(); ++i)
    add(body.symmetry(i).surface(), where + ".symmetry[" + std::to_string(i) + "].surface");
  return nodes;
}

SolidMesh read(const v1::Body& body, const std::string& where, const std::filesystem::path& scene_folder) {
  const MeshReading reading = read_mesh(scene_folder / body.mesh_file().file(), body.mesh_file().length_unit());
  if (!reading.note.empty())
    std::fprintf(stderr, "solid-server: %s: %s\n", body.mesh_file().file().c_str(), reading.note.c_str());
  const std::vector<Index> supported = supported_nodes(body, reading.mesh, where);
  if (!supported.empty()) check_connected(reading.mesh, supported, where + ".mesh_file");
  return reading.mesh;
}

Eigen::Isometry3d make_placement(const v1::Placement& placement, const std::string& where) {
  const Eigen::Vector3d axis =
      placement.has_rotation_axis() ? vector_of(placement.rotation_axis()) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  if (!(axis.norm() > 0))
    throw report::SceneError(where + ".rotation_axis", "the axis (0, 0, 0) has no direction", "give it a length");
  const double angle = placement.rotation_angle() * std::numbers::pi / 180;
  return Eigen::Translation3d(vector_of(placement.translation())) * Eigen::AngleAxisd(angle, axis.normalized());
}

SolidMesh make_or_read(const v1::Body& body, const std::string& where, const std::filesystem::path& scene_folder) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold:
      return make(body.vocal_fold());
    case v1::Body::kBox:
      return make(body.box());
    case v1::Body::kValve:
      return make(body.valve());
    case v1::Body::kCylinderBeam:
      return make(body.cylinder_beam());
    case v1::Body::kMeshFile:
      return read(body, where, scene_folder);
    case v1::Body::kAnnulus:
      return make(body.annulus());
    case v1::Body::kHollowSphere:
      return make(body.hollow_sphere());
    case v1::Body::kBall:
      return make(body.ball());
    case v1::Body::kArch:
      return make(body.arch());
    case v1::Body::MESH_NOT_SET:
      break;
  }
  throw report::SceneError(where, "the body has no mesh", "give one, for example box");
}

}  // namespace

SolidMesh make_mesh(const v1::Body& body, const std::string& where, const std::filesystem::path& scene_folder) {
  SolidMesh mesh;
  try {
    mesh = make_or_read(body, where, scene_folder);
  } catch (const report::SceneError& error) {
    if (body.has_mesh_file()) throw;
    throw report::SceneError(where + "." + error.where(), error.sentence(), error.advice());
  }
  if (body.has_placement()) place_mesh(make_placement(body.placement(), where + ".placement"), mesh);
  return mesh;
}

}  // namespace couplet::solid
