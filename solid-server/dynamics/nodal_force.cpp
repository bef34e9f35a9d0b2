#include "solid-server/dynamics/nodal_force.hpp"

#include <algorithm>
#include <chrono>

namespace couplet::solid {

NodalForce::NodalForce(const SolidMesh& mesh, const Material& material, int n_points, const WettedSurface& wetted,
                       const std::vector<PressureLoad>& pressures, const std::vector<RigidPlane>& planes, int n_members)
    : n_nodes_(mesh.n_nodes()),
      n_members_(n_members),
      material_(material),
      elements_(make_element_packs(mesh, n_points)),
      surface_(mesh, wetted, pressures, planes),
      plan_(make_sweep_plan(elements_, n_nodes_, surface_.parts(), n_members)),
      buffer_(plan_.n_element_packs + surface_.n_packs(), StoredPack{}),
      energy_(static_cast<std::size_t>(elements_.n_packs), StoredPack{}) {}

void NodalForce::compute(int member, const SweepPlan::Chunk& chunk, const double* displacement, const Moment& moment) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  note_inverted(internal_force(elements_, material_, chunk.first_pack, chunk.last_pack, displacement,
                               &buffer_[static_cast<std::size_t>(chunk.place)],
                               moment.with_energy ? energy_.data() : nullptr));
  if (member == 0) element_seconds_ += std::chrono::duration<double>(Clock::now() - began).count();
}

void NodalForce::note_inverted(Index element) {
  if (element < 0) return;
  Index known = inverted_element_;
  while ((known < 0 || element < known) && !inverted_element_.compare_exchange_weak(known, element)) continue;
}

NodeVectors NodalForce::collect(const NodeVectors& displacement, const Moment& moment) {
  NodeVectors force(n_nodes_, 4);
  const auto keep = [&](Index node, const NodeQuad& sum) { std::memcpy(&force(node, 0), &sum, sizeof sum); };
  for (int member = 0; member < n_members_; ++member) sweep(member, displacement.data(), moment, keep);
  for (int member = 0; member < n_members_; ++member) visit_shared(member, keep);
  return force;
}

NodeVectors NodalForce::internal_only(const NodeVectors& displacement) {
  const std::vector<StoredPack> kept(buffer_.begin() + static_cast<std::ptrdiff_t>(plan_.n_element_packs),
                                     buffer_.end());
  std::fill_n(surface_buffer(), surface_.n_packs(), StoredPack{});
  NodeVectors force = collect(displacement, {});
  std::copy(kept.begin(), kept.end(), surface_buffer());
  return force;
}

NodeVectors NodalForce::all(const NodeVectors& displacement, const Moment& moment) {
  for (int member = 0; member < n_members_; ++member) write_surface_parts(member, displacement.data(), moment);
  return collect(displacement, moment);
}

double NodalForce::strain_energy() const {
  double sum = 0;
  for (std::size_t n = 0; n < elements_.lane_element.size(); ++n)
    if (elements_.lane_element[n] >= 0) sum += energy_[n / n_lanes].lane[n % n_lanes];
  return sum;
}

std::size_t NodalForce::memory_bytes() const {
  return (elements_.geometry.size() + buffer_.size() + energy_.size()) * sizeof(StoredPack) +
         (elements_.node_start.size() + plan_.part_start.size()) * sizeof(Index);
}

}  // namespace couplet::solid
