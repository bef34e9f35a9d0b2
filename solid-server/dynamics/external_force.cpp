#include "solid-server/dynamics/external_force.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/load/surface_rim.hpp"

namespace couplet::solid {

namespace {

std::vector<FaceNodes> faces_of(const SolidMesh& mesh, const std::string& surface, const std::string& where) {
  std::vector<FaceNodes> faces;
  for (const ElementFace& face : mesh.find_surface(surface, where)) faces.push_back(mesh.nodes_of(face));
  return faces;
}

}  // namespace

ExternalForce::ExternalForce(const SolidMesh& mesh, const WettedSurface& wetted, PrescribedLoads loads,
                             const std::vector<RigidPlane>& planes, std::vector<ContactPair> pairs)
    : n_nodes_(mesh.n_nodes()), surface_contact_(mesh, std::move(pairs)), wetted_node_(wetted.solid_node) {
  for (std::size_t l = 0; l < loads.pressures.size(); ++l) {
    const std::string where = "solid.pressure[" + std::to_string(l) + "].surface";
    const std::vector<FaceNodes> all = faces_of(mesh, loads.pressures[l].surface, where);
    const std::vector<Index> rim = nodes_of_rim(all);
    for (const auto& faces : group_by_shape(all)) {
      pressures_.push_back({make_face_packs(mesh, faces), loads.pressures[l].value, n_packs_, rim});
      add_face_parts(pressures_.back().faces, faces);
    }
  }
  first_contact_part_ = parts_.size();
  add_planes(mesh, wetted, planes);
  surface_contact_first_pack_ = add_node_parts(surface_contact_.node());
  last_contact_part_ = parts_.size();
  for (const Index node : surface_contact_.node()) {
    const auto found = std::lower_bound(wetted_node_.begin(), wetted_node_.end(), node);
    const bool is_wetted = found != wetted_node_.end() && *found == node;
    wetted_number_.push_back(is_wetted ? static_cast<Index>(found - wetted_node_.begin()) : -1);
  }
  for (DeadLoad& load : loads.dead) {
    const std::size_t first_pack = add_node_parts(load.node);
    dead_.push_back({std::move(load), first_pack});
  }
  interface_first_pack_ = add_node_parts(wetted_node_);
  interface_start_ = interface_change_ = NodeVectors::Zero(static_cast<Eigen::Index>(wetted_node_.size()), 4);
  add_cancelled_parts();
}

/// One for each contact node, of which only wetted ones are ever written.
void ExternalForce::add_cancelled_parts() {
  const std::vector<Index>& node = surface_contact_.node();
  if (std::all_of(wetted_number_.begin(), wetted_number_.end(), [](Index wetted) { return wetted < 0; })) return;
  for (std::size_t n = 0; n < node.size(); ++n)
    cancelled_.push_back({node[n], static_cast<Index>(n_packs_) * n_lanes + 4 * static_cast<Index>(n)});
  n_packs_ += (node.size() + 1) / 2;
}

std::vector<ForcePart> ExternalForce::load_parts() const {
  std::vector<ForcePart> loads = cancelled_;
  for (std::size_t n = 0; n < parts_.size(); ++n)
    if (n < first_contact_part_ || n >= last_contact_part_) loads.push_back(parts_[n]);
  return loads;
}

void ExternalForce::add_planes(const SolidMesh& mesh, const WettedSurface& wetted,
                               const std::vector<RigidPlane>& planes) {
  for (std::size_t n = 0; n < planes.size(); ++n) {
    const std::string where = "solid.rigid_plane[" + std::to_string(n) + "]";
    if (!(planes[n].normal.norm() > 0))
      throw report::SceneError(where + ".plane.normal", "the normal has no direction",
                               "give a vector towards the side where bodies are");
    std::vector<FaceNodes> touching = planes[n].surfaces.empty() ? wetted.face : std::vector<FaceNodes>{};
    for (const std::string& surface : planes[n].surfaces)
      for (const FaceNodes& face : faces_of(mesh, surface, where + ".surface")) touching.push_back(face);
    if (touching.empty())
      throw report::SceneError(where, "no surface is wetted, so nothing can touch the plane",
                               "name the surfaces that may touch it in " + where + ".surface");
    for (const auto& faces : group_by_shape(touching)) {
      planes_.emplace_back(mesh, faces, planes[n]);
      plane_first_pack_.push_back(n_packs_);
      was_touching_.emplace_back(static_cast<std::size_t>(planes_.back().n_packs()), 0);
      add_face_parts(planes_.back().faces(), faces);
    }
  }
}

/// Makes room for forces on faces at the end of the buffer.
void ExternalForce::add_face_parts(const FacePacks& packs, const std::vector<FaceNodes>& faces) {
  for (std::size_t face = 0; face < faces.size(); ++face)
    for (int a = 0; a < packs.n_nodes; ++a)
      parts_.push_back({faces[face][static_cast<std::size_t>(a)],
                        static_cast<Index>(n_packs_) * n_lanes + face_force_start(packs, static_cast<Index>(face), a)});
  n_packs_ += static_cast<std::size_t>(packs.n_packs * packs.packs_of_force());
}

/// Makes room for one force a node; where it begins.
std::size_t ExternalForce::add_node_parts(const std::vector<Index>& nodes) {
  const std::size_t first_pack = n_packs_;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    parts_.push_back({nodes[n], static_cast<Index>(first_pack) * n_lanes + 4 * static_cast<Index>(n)});
  n_packs_ += (nodes.size() + 1) / 2;  // two nodes of four numbers in a pack
  return first_pack;
}

void ExternalForce::set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end) {
  interface_start_.leftCols<3>() = start;
  interface_change_.leftCols<3>() = end - start;
}

NodeVectors ExternalForce::interface_load_at_start() const {
  NodeVectors load = NodeVectors::Zero(n_nodes_, 4);
  for (std::size_t n = 0; n < wetted_node_.size(); ++n)
    load.row(wetted_node_[n]) = interface_start_.row(static_cast<Eigen::Index>(n));
  return load;
}

void ExternalForce::write(int member, int n_members, const double* displacement, double time, double fraction,
                          StoredPack* buffer) {
  for (const PressedSurface& surface : pressures_) {
    const auto [first, last] = share_of(surface.faces.n_packs, member, n_members);
    pressure_force(surface.faces, first, last, surface.pressure(time), displacement, buffer + surface.first_pack);
  }
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    const auto [first, last] = share_of(planes_[n].n_packs(), member, n_members);
    planes_[n].force(first, last, displacement, buffer + plane_first_pack_[n], was_touching_[n].data());
  }
  for (const PlacedLoad& placed : dead_) {
    const auto [first, last] = share_of(static_cast<int>(placed.load.node.size()), member, n_members);
    const Eigen::Vector3d value = placed.load.value(time);
    double* const part = &buffer[placed.first_pack].lane[0];
    for (int n = first; n < last; ++n)
      for (int i = 0; i < 3; ++i) part[4 * n + i] = placed.load.weight[static_cast<std::size_t>(n)] * value[i];
  }
  write_interface_load(member, n_members, fraction, buffer);
}

/// Contact takes back what it cancels in its own places, since the members share the nodes there in another way.
void ExternalForce::write_interface_load(int member, int n_members, double fraction, StoredPack* buffer) {
  if (!surface_contact_.is_empty()) {
    double* const part = &buffer[surface_contact_first_pack_].lane[0];
    surface_contact_.write(member, n_members, part);
    const auto [first, last] = share_of(surface_contact_.n_nodes(), member, n_members);
    for (Index n = first; n < last; ++n) {
      const Index wetted = wetted_number_[static_cast<std::size_t>(n)];
      const double factor = surface_contact_.interface_load_factor(n);
      if (wetted < 0) continue;
      double* const cancelled = &buffer->lane[0] + cancelled_[static_cast<std::size_t>(n)].start;
      for (int i = 0; i < 3; ++i) {
        cancelled[i] = (factor - 1) * (interface_start_(wetted, i) + fraction * interface_change_(wetted, i));
        part[4 * n + i] += cancelled[i];
      }
    }
  }
  if (!wetted_node_.empty()) {
    const auto [first, last] = share_of(static_cast<int>(wetted_node_.size()), member, n_members);
    Eigen::Map<NodeVectors> part(&buffer[interface_first_pack_].lane[0], interface_start_.rows(), 4);
    part.middleRows(first, last - first) =
        interface_start_.middleRows(first, last - first) + fraction * interface_change_.middleRows(first, last - first);
  }
}

ExternalForce::ContactTotal ExternalForce::contact_total(const double* displacement) {
  ContactTotal sum;
  for (const PlaneContact& plane : planes_) {
    const PlaneContact::Total total = plane.total(displacement);
    sum.energy += total.energy;
    sum.force += total.force;
  }
  if (surface_contact_.is_empty()) return sum;
  const SurfaceContact::Total total = surface_contact_.total(displacement);
  return {sum.energy + total.energy, sum.force + total.force, total.smallest_distance};
}

bool ExternalForce::is_touching() const {
  return surface_contact_.is_touching() ||
         std::any_of(was_touching_.begin(), was_touching_.end(), [](const auto& packs) {
           return std::any_of(packs.begin(), packs.end(), [](char touches) { return touches != 0; });
         });
}

Eigen::VectorXd ExternalForce::contact_stiffness_bound() const {
  Eigen::VectorXd bound = surface_contact_.stiffness_bound(n_nodes_);
  for (const PlaneContact& plane : planes_) bound += plane.stiffness_bound(n_nodes_);
  return bound;
}

void ExternalForce::add_stiffness(const NodeVectors& displacement, double time, const TakeStiffness& take,
                                  const TakeStiffness& take_rim) {
  for (const PressedSurface& surface : pressures_) {
    const auto is_on_rim = [&](Index node) { return std::binary_search(surface.rim.begin(), surface.rim.end(), node); };
    pressure_stiffness(surface.faces, surface.pressure(time), displacement,
                       [&](Index a, Index b, const Eigen::Matrix3d& block) {
                         take(a, b, block);
                         if (is_on_rim(a) && is_on_rim(b)) take_rim(a, b, block);
                       });
  }
  for (const PlaneContact& plane : planes_) {
    const Eigen::Matrix3d along_normal = plane.normal() * plane.normal().transpose();
    plane.stiffness(displacement.data(), [&](Index a, Index b, double s) { take(a, b, s * along_normal); });
  }
  for (const auto& [weights, stiffness] : surface_contact_.stiffness(displacement.data()))
    for (const auto& [a, c_a] : weights)
      for (const auto& [b, c_b] : weights) take(a, b, stiffness * c_a * c_b.transpose());
}

}  // namespace couplet::solid
