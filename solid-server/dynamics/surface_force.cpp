#include "solid-server/dynamics/surface_force.hpp"

#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

namespace {

std::vector<FaceNodes> faces_of(const SolidMesh& mesh, const std::string& surface, const std::string& where) {
  std::vector<FaceNodes> faces;
  for (const ElementFace& face : mesh.find_surface(surface, where)) faces.push_back(mesh.nodes_of(face));
  return faces;
}

}  // namespace

SurfaceForce::SurfaceForce(const SolidMesh& mesh, const WettedSurface& wetted,
                           const std::vector<PressureLoad>& pressures, const std::vector<RigidPlane>& planes)
    : n_nodes_(mesh.n_nodes()),
      contact_(mesh, planes.empty() ? std::vector<FaceNodes>{} : wetted.face, planes),
      wetted_node_(wetted.solid_node) {
  for (std::size_t l = 0; l < pressures.size(); ++l) {
    const auto faces = faces_of(mesh, pressures[l].surface, "solid.pressure[" + std::to_string(l) + "].surface");
    loads_.push_back({make_face_packs(mesh, faces), pressures[l].value, n_packs_});
    add_parts(faces);
  }
  contact_first_pack_ = n_packs_;
  was_touching_.assign(static_cast<std::size_t>(contact_.n_packs()), 0);
  if (!contact_.is_empty()) add_parts(wetted.face);

  interface_first_pack_ = n_packs_;
  const auto n_wetted = static_cast<Index>(wetted_node_.size());
  for (Index n = 0; n < n_wetted; ++n)
    parts_.push_back({wetted_node_[static_cast<std::size_t>(n)], static_cast<Index>(n_packs_) * n_lanes + 4 * n});
  n_packs_ += static_cast<std::size_t>(n_wetted + 1) / 2;  // two nodes of four numbers in a pack
  interface_start_ = interface_change_ = NodeVectors::Zero(n_wetted, 4);
}

/// Makes room for forces on faces at the end of the buffer.
void SurfaceForce::add_parts(const std::vector<FaceNodes>& faces) {
  const auto n_faces = static_cast<Index>(faces.size());
  for (Index face = 0; face < n_faces; ++face)
    for (int a = 0; a < hex20::n_face_nodes; ++a)
      parts_.push_back({faces[static_cast<std::size_t>(face)][static_cast<std::size_t>(a)],
                        static_cast<Index>(n_packs_) * n_lanes + face_force_start(face, a)});
  n_packs_ += static_cast<std::size_t>((n_faces + n_lanes - 1) / n_lanes * packs_per_face_pack);
}

void SurfaceForce::set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end) {
  interface_start_.leftCols<3>() = start;
  interface_change_.leftCols<3>() = end - start;
}

NodeVectors SurfaceForce::interface_load_at_start() const {
  NodeVectors load = NodeVectors::Zero(n_nodes_, 4);
  for (std::size_t n = 0; n < wetted_node_.size(); ++n)
    load.row(wetted_node_[n]) = interface_start_.row(static_cast<Eigen::Index>(n));
  return load;
}

void SurfaceForce::write(int member, int n_members, const double* displacement, double time, double fraction,
                         StoredPack* buffer) {
  for (const LoadedSurface& load : loads_) {
    const auto [first, last] = share_of(load.faces.n_packs, member, n_members);
    pressure_force(load.faces, first, last, load.pressure(time), displacement, buffer + load.first_pack);
  }
  if (!contact_.is_empty()) {
    const auto [first, last] = share_of(contact_.n_packs(), member, n_members);
    contact_.force(first, last, displacement, buffer + contact_first_pack_, was_touching_.data());
  }
  if (!wetted_node_.empty()) {
    const auto [first, last] = share_of(static_cast<int>(wetted_node_.size()), member, n_members);
    Eigen::Map<NodeVectors> part(&buffer[interface_first_pack_].lane[0], interface_start_.rows(), 4);
    part.middleRows(first, last - first) =
        interface_start_.middleRows(first, last - first) + fraction * interface_change_.middleRows(first, last - first);
  }
}

}  // namespace couplet::solid
