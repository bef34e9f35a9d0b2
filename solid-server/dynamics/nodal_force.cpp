#include "solid-server/dynamics/nodal_force.hpp"

#include <algorithm>
#include <chrono>

#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

namespace {

std::vector<FaceNodes> faces_of(const SolidMesh& mesh, const std::string& surface, const std::string& where) {
  std::vector<FaceNodes> faces;
  for (const ElementFace& face : mesh.find_surface(surface, where)) faces.push_back(mesh.nodes_of(face));
  return faces;
}

void add_parts(const std::vector<FaceNodes>& faces, std::size_t first_pack, std::vector<ForcePart>& parts) {
  for (Index face = 0; face < static_cast<Index>(faces.size()); ++face)
    for (int a = 0; a < hex20::n_face_nodes; ++a)
      parts.push_back({faces[static_cast<std::size_t>(face)][static_cast<std::size_t>(a)],
                       static_cast<Index>(first_pack) * n_lanes + face_force_start(face, a)});
}

}  // namespace

NodalForce::NodalForce(const SolidMesh& mesh, const Material& material, int n_points, const WettedSurface& wetted,
                       const std::vector<PressureLoad>& pressures, const std::vector<RigidPlane>& planes)
    : n_nodes_(mesh.n_nodes()),
      material_(material),
      elements_(make_element_packs(mesh, n_points)),
      contact_(mesh, planes.empty() ? std::vector<FaceNodes>{} : wetted.face, planes),
      gather_(0, {}),
      wetted_node_(wetted.solid_node) {
  std::vector<ForcePart> parts;
  for (Index element = 0; element < mesh.n_elements(); ++element)
    for (int a = 0; a < hex20::n_nodes; ++a)
      parts.push_back({mesh.element_node[static_cast<std::size_t>(element)][static_cast<std::size_t>(a)],
                       element_force_start(element, a)});
  auto n_packs = static_cast<std::size_t>(elements_.n_packs) * packs_per_element_pack;

  for (std::size_t l = 0; l < pressures.size(); ++l) {
    const auto faces = faces_of(mesh, pressures[l].surface, "solid.pressure[" + std::to_string(l) + "].surface");
    loads_.push_back({make_face_packs(mesh, faces), pressures[l].value, n_packs});
    add_parts(faces, n_packs, parts);
    n_packs += static_cast<std::size_t>(loads_.back().faces.n_packs) * packs_per_face_pack;
  }

  contact_first_pack_ = n_packs;
  if (!contact_.is_empty()) {
    add_parts(wetted.face, n_packs, parts);
    n_packs += static_cast<std::size_t>(contact_.n_packs()) * packs_per_face_pack;
  }

  interface_first_pack_ = n_packs;
  const auto n_wetted = static_cast<Index>(wetted.solid_node.size());
  for (Index n = 0; n < n_wetted; ++n)
    parts.push_back({wetted.solid_node[static_cast<std::size_t>(n)], static_cast<Index>(n_packs) * n_lanes + 4 * n});
  n_packs += static_cast<std::size_t>(n_wetted + 1) / 2;  // two nodes of four numbers in a pack
  interface_start_ = interface_change_ = NodeVectors::Zero(n_wetted, 4);

  gather_ = ForceGather(n_nodes_, parts);
  buffer_.assign(n_packs, StoredPack{});
  energy_.assign(static_cast<std::size_t>(elements_.n_packs), StoredPack{});
  was_touching_.assign(static_cast<std::size_t>(contact_.n_packs()), 0);
}

void NodalForce::set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end) {
  interface_start_.leftCols<3>() = start;
  interface_change_.leftCols<3>() = end - start;
}

NodeVectors NodalForce::interface_load_at_start() const {
  NodeVectors load = NodeVectors::Zero(n_nodes_, 4);
  for (std::size_t n = 0; n < wetted_node_.size(); ++n)
    load.row(wetted_node_[n]) = interface_start_.row(static_cast<Eigen::Index>(n));
  return load;
}

void NodalForce::write_parts(int member, int n_members, const double* displacement, const Moment& moment) {
  const auto [first, last] = share_of(elements_.n_packs, member, n_members);
  const auto began = std::chrono::steady_clock::now();
  note_inverted(internal_force(elements_, material_, first, last, displacement, buffer_.data(),
                               moment.with_energy ? energy_.data() : nullptr));
  if (member == 0) element_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  for (const LoadedSurface& load : loads_) {
    const auto [load_first, load_last] = share_of(load.faces.n_packs, member, n_members);
    pressure_force(load.faces, load_first, load_last, load.pressure(moment.time), displacement,
                   &buffer_[load.first_pack]);
  }
  if (!contact_.is_empty()) {
    const auto [contact_first, contact_last] = share_of(contact_.n_packs(), member, n_members);
    contact_.force(contact_first, contact_last, displacement, &buffer_[contact_first_pack_], was_touching_.data());
  }
  if (interface_start_.rows() > 0) {
    const auto [node_first, node_last] = share_of(static_cast<int>(interface_start_.rows()), member, n_members);
    Eigen::Map<NodeVectors> part(&buffer_[interface_first_pack_].lane[0], interface_start_.rows(), 4);
    const Index n_nodes = node_last - node_first;
    part.middleRows(node_first, n_nodes) = interface_start_.middleRows(node_first, n_nodes) +
                                           moment.fraction * interface_change_.middleRows(node_first, n_nodes);
  }
}

void NodalForce::note_inverted(Index element) {
  if (element < 0) return;
  Index known = inverted_element_;
  while ((known < 0 || element < known) && !inverted_element_.compare_exchange_weak(known, element)) continue;
}

NodeVectors NodalForce::internal_only(const NodeVectors& displacement) const {
  std::vector<StoredPack> buffer(buffer_.size(), StoredPack{});
  internal_force(elements_, material_, 0, elements_.n_packs, displacement.data(), buffer.data(), nullptr);
  NodeVectors force(n_nodes_, 4);
  for (Index node = 0; node < n_nodes_; ++node) {
    const NodeQuad sum = gather_.sum(node, &buffer.data()->lane[0]);
    for (int i = 0; i < 4; ++i) force(node, i) = sum[i];
  }
  return force;
}

double NodalForce::strain_energy() const {
  double sum = 0;
  for (Index element = 0; element < elements_.n_elements; ++element)
    sum += energy_[static_cast<std::size_t>(element / n_lanes)].lane[element % n_lanes];
  return sum;
}

std::size_t NodalForce::memory_bytes() const {
  return (elements_.geometry.size() + buffer_.size() + energy_.size()) * sizeof(StoredPack) +
         elements_.node_start.size() * sizeof(Index);
}

}  // namespace couplet::solid
