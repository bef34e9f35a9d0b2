#include "solid-server/dynamics/external_force.hpp"

#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

namespace {

std::vector<FaceNodes> faces_of(const SolidMesh& mesh, const std::string& surface, const std::string& where) {
  std::vector<FaceNodes> faces;
  for (const ElementFace& face : mesh.find_surface(surface, where)) faces.push_back(mesh.nodes_of(face));
  return faces;
}

}  // namespace

ExternalForce::ExternalForce(const SolidMesh& mesh, const WettedSurface& wetted, PrescribedLoads loads,
                             const std::vector<RigidPlane>& planes)
    : n_nodes_(mesh.n_nodes()),
      contact_(mesh, planes.empty() ? std::vector<FaceNodes>{} : wetted.face, planes),
      wetted_node_(wetted.solid_node) {
  for (std::size_t l = 0; l < loads.pressures.size(); ++l) {
    const std::string where = "solid.pressure[" + std::to_string(l) + "].surface";
    for (const auto& faces : group_by_shape(faces_of(mesh, loads.pressures[l].surface, where))) {
      pressures_.push_back({make_face_packs(mesh, faces), loads.pressures[l].value, n_packs_});
      add_face_parts(pressures_.back().faces, faces);
    }
  }
  contact_first_pack_ = n_packs_;
  was_touching_.assign(static_cast<std::size_t>(contact_.n_packs()), 0);
  if (!contact_.is_empty()) add_face_parts(contact_.faces(), wetted.face);
  for (DeadLoad& load : loads.dead) {
    const std::size_t first_pack = add_node_parts(load.node);
    dead_.push_back({std::move(load), first_pack});
  }
  interface_first_pack_ = add_node_parts(wetted_node_);
  interface_start_ = interface_change_ = NodeVectors::Zero(static_cast<Eigen::Index>(wetted_node_.size()), 4);
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
  if (!contact_.is_empty()) {
    const auto [first, last] = share_of(contact_.n_packs(), member, n_members);
    contact_.force(first, last, displacement, buffer + contact_first_pack_, was_touching_.data());
  }
  for (const PlacedLoad& placed : dead_) {
    const auto [first, last] = share_of(static_cast<int>(placed.load.node.size()), member, n_members);
    const Eigen::Vector3d value = placed.load.value(time);
    double* const part = &buffer[placed.first_pack].lane[0];
    for (int n = first; n < last; ++n)
      for (int i = 0; i < 3; ++i) part[4 * n + i] = placed.load.weight[static_cast<std::size_t>(n)] * value[i];
  }
  if (!wetted_node_.empty()) {
    const auto [first, last] = share_of(static_cast<int>(wetted_node_.size()), member, n_members);
    Eigen::Map<NodeVectors> part(&buffer[interface_first_pack_].lane[0], interface_start_.rows(), 4);
    part.middleRows(first, last - first) =
        interface_start_.middleRows(first, last - first) + fraction * interface_change_.middleRows(first, last - first);
  }
}

void ExternalForce::add_stiffness(const NodeVectors& displacement, double time, const TakeStiffness& take) const {
  for (const PressedSurface& surface : pressures_)
    pressure_stiffness(surface.faces, surface.pressure(time), displacement, take);
  if (!contact_.is_empty()) contact_.stiffness(displacement.data(), take);
}

}  // namespace couplet::solid
