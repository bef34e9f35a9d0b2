#include "solid-server/dynamics/nodal_force.hpp"

#include <algorithm>
#include <chrono>

namespace couplet::solid {

namespace {

/// The smaller one of two elements, where -1 is none: the same on any number of threads.
void keep_smaller(Index element, std::atomic<Index>& kept) {
  if (element < 0) return;
  Index known = kept;
  while ((known < 0 || element < known) && !kept.compare_exchange_weak(known, element)) continue;
}

}  // namespace

NodalForce::NodalForce(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, ExternalForce external,
                       int n_members)
    : n_nodes_(mesh.n_nodes()), n_members_(n_members), external_(std::move(external)) {
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const BlockProperties& property = properties[b];
    check_formulation("solid.body", mesh.block[b].shape, property.formulation, property.material);
    Block& block = blocks_.emplace_back();
    block.material = property.material;
    block.elements = make_element_packs(mesh, mesh.block[b], property.n_points, property.formulation);
    block.energy.assign(static_cast<std::size_t>(block.elements.n_packs), StoredPack{});
  }
  plan_ = make_sweep_plan(element_packs(), n_nodes_, external_.parts(), n_members);
  buffer_.assign(plan_.n_element_packs + external_.n_packs(), StoredPack{});
}

std::vector<const ElementPacks*> NodalForce::element_packs() const {
  std::vector<const ElementPacks*> packs;
  for (const Block& block : blocks_) packs.push_back(&block.elements);
  return packs;
}

void NodalForce::compute(int member, const SweepPlan::Chunk& chunk, const double* displacement, const Moment& moment) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  Block& block = blocks_[static_cast<std::size_t>(chunk.block)];
  note(internal_force(block.elements, block.material, chunk.first_pack, chunk.last_pack, displacement,
                      &buffer_[static_cast<std::size_t>(chunk.place)],
                      moment.with_energy ? block.energy.data() : nullptr));
  if (member == 0) element_seconds_ += std::chrono::duration<double>(Clock::now() - began).count();
}

void NodalForce::note(const ElementFindings& findings) {
  keep_smaller(findings.inverted, inverted_element_);
  keep_smaller(findings.softened, softened_element_);
  if (findings.n_softened > 0) n_softened_ += findings.n_softened;
}

NodeVectors NodalForce::collect(const NodeVectors& displacement, const Moment& moment) {
  NodeVectors force(n_nodes_, 4);
  const auto keep = [&](Index node, const NodeQuad& sum) { std::memcpy(&force(node, 0), &sum, sizeof sum); };
  for (int member = 0; member < n_members_; ++member) sweep(member, displacement.data(), moment, keep);
  for (int member = 0; member < n_members_; ++member) visit_shared(member, keep);
  return force;
}

template <class Evaluate>
void NodalForce::without_external_parts(const Evaluate& evaluate) {
  const std::vector<StoredPack> kept(buffer_.begin() + static_cast<std::ptrdiff_t>(plan_.n_element_packs),
                                     buffer_.end());
  std::fill_n(external_buffer(), external_.n_packs(), StoredPack{});
  evaluate();
  std::copy(kept.begin(), kept.end(), external_buffer());
}

NodeVectors NodalForce::internal_only(const NodeVectors& displacement) {
  NodeVectors force;
  without_external_parts([&] { force = collect(displacement, {}); });
  return force;
}

void NodalForce::internal_only(const NodeVectors& displacement, WorkTeam& team, NodeVectors& force) {
  const auto keep = [&](Index node, const NodeQuad& sum) { std::memcpy(&force(node, 0), &sum, sizeof sum); };
  without_external_parts([&] {
    team.run([&](int member) {
      sweep(member, displacement.data(), {}, keep);
      team.barrier();
      visit_shared(member, keep);
    });
  });
}

NodeVectors NodalForce::all(const NodeVectors& displacement, const Moment& moment) {
  if (has_surface_contact()) search_contact(displacement.data());
  for (int member = 0; member < n_members_; ++member) find_gaps(member);
  for (int member = 0; member < n_members_; ++member) write_external_parts(member, displacement.data(), moment);
  return collect(displacement, moment);
}

double NodalForce::strain_energy() const {
  double sum = 0;
  for (const Block& block : blocks_)
    for (std::size_t n = 0; n < block.elements.lane_element.size(); ++n)
      if (block.elements.lane_element[n] >= 0) sum += block.energy[n / n_lanes].lane[n % n_lanes];
  return sum;
}

std::size_t NodalForce::memory_bytes() const {
  std::size_t n_packs = buffer_.size(), n_indices = plan_.part_start.size();
  for (const Block& block : blocks_) {
    n_packs += block.elements.geometry.size() + block.elements.axes.size() + block.energy.size();
    n_indices += block.elements.node_start.size();
  }
  return n_packs * sizeof(StoredPack) + n_indices * sizeof(Index);
}

}  // namespace couplet::solid
