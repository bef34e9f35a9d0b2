#pragma once
// All forces on the nodes of a body at given displacements and time: internal, interface load, prescribed loads,
// contact.

#include <atomic>

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/assembly/sweep_plan.hpp"
#include "solid-server/dynamics/external_force.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/internal_force.hpp"

namespace couplet::solid {

/// What a force depends on besides displacements.
struct Moment {
  double time = 0;           // [s]
  double fraction = 0;       // of the coupling step
  bool with_energy = false;  // strain energy is kept, and every law looks for inverted elements
};

/// Elements whose law answers more compression with less stress.
struct SoftenedElements {
  Index first = -1;  // -1: none
  int n = 0;
};

/// Evaluated by a team in three phases with a barrier after each: write_external_parts, sweep, visit_shared. The last
/// two call visit(node, force) exactly once for each node; from then on nobody reads its displacement, so that it may
/// be changed there.
class NodalForce {
 public:
  /// `properties` of each block of the mesh.
  NodalForce(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, ExternalForce external,
             int n_members);

  /// Before that, where surfaces may touch: looked for by one member, then measured by all, with a barrier after each.
  bool has_surface_contact() const { return external_.has_surface_contact(); }
  void search_contact(const double* displacement) { external_.search_contact(displacement); }
  void find_gaps(int member) { external_.find_gaps(member, n_members_); }

  void write_external_parts(int member, const double* displacement, const Moment& moment) {
    external_.write(member, n_members_, displacement, moment.time, moment.fraction, external_buffer());
  }

  /// An inverted element that is found is kept (inverted_element).
  template <class Visit>
  void sweep(int member, const double* displacement, const Moment& moment, const Visit& visit) {
    const auto m = static_cast<std::size_t>(member);
    for (Index c = plan_.first_chunk[m]; c < plan_.first_chunk[m + 1]; ++c) {
      const SweepPlan::Chunk& chunk = plan_.chunks[static_cast<std::size_t>(c)];
      compute(member, chunk, displacement, moment);
      visit_nodes(chunk.first_visit, chunk.last_visit, visit);
    }
  }

  template <class Visit>
  void visit_shared(int member, const Visit& visit) const {
    const auto m = static_cast<std::size_t>(member);
    visit_nodes(plan_.first_shared_visit[m], plan_.first_shared_visit[m + 1], visit);
  }

  /// The internal force alone, (n_nodes, 4) [N].
  NodeVectors internal_only(const NodeVectors& displacement);  // by one thread
  void internal_only(const NodeVectors& displacement, WorkTeam& team, NodeVectors& force);
  /// All forces, by one thread: (n_nodes, 4) [N].
  NodeVectors all(const NodeVectors& displacement, const Moment& moment);

  /// The first element found turned inside out since the last call of forget_findings, or -1.
  Index inverted_element() const { return inverted_element_; }
  /// What sweeps with energy found since then of elements that have lost stiffness in compression.
  SoftenedElements softened() const { return {softened_element_, n_softened_}; }
  void forget_findings() {
    inverted_element_ = softened_element_ = -1;
    n_softened_ = 0;
  }

  double strain_energy() const;                                // at the last moment with energy [J]
  double element_seconds() const { return element_seconds_; }  // that the first member has spent in internal_force [s]
  ExternalForce& external() { return external_; }
  /// What write_external_parts has written last.
  const double* external_parts() const { return &buffer_.data()->lane[0] + plan_.n_element_packs * n_lanes; }
  std::size_t memory_bytes() const;

 private:
  struct Block {
    Material material;
    ElementPacks elements;
    std::vector<StoredPack> energy;  // of each element [J], (n_packs)
  };

  template <class Visit>
  void visit_nodes(Index first, Index last, const Visit& visit) const {
    for (Index n = first; n < last; ++n)
      visit(plan_.visit_node[static_cast<std::size_t>(n)], plan_.sum(n, &buffer_.data()->lane[0]));
  }
  StoredPack* external_buffer() { return buffer_.data() + plan_.n_element_packs; }
  void compute(int member, const SweepPlan::Chunk& chunk, const double* displacement, const Moment& moment);
  std::vector<const ElementPacks*> element_packs() const;
  NodeVectors collect(const NodeVectors& displacement, const Moment& moment);
  /// Calls evaluate with no force from outside the elements.
  template <class Evaluate>
  void without_external_parts(const Evaluate& evaluate);
  void note(const ElementFindings& findings);

  Index n_nodes_;
  int n_members_;
  std::vector<Block> blocks_;
  ExternalForce external_;
  SweepPlan plan_;
  std::vector<StoredPack> buffer_;  // parts of forces [N]: of elements, then external ones
  std::atomic<Index> inverted_element_{-1}, softened_element_{-1};
  std::atomic<int> n_softened_{0};
  double element_seconds_ = 0;
};

}  // namespace couplet::solid
