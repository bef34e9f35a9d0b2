#pragma once
// All forces on the nodes of a body at given displacements and time: internal, interface load, prescribed pressures,
// contact.

#include <atomic>

#include "solid-server/assembly/sweep_plan.hpp"
#include "solid-server/dynamics/surface_force.hpp"
#include "solid-server/element/internal_force.hpp"

namespace couplet::solid {

/// What a force depends on besides displacements.
struct Moment {
  double time = 0;           // [s]
  double fraction = 0;       // of the coupling step
  bool with_energy = false;  // strain energy is kept, and every law looks for inverted elements
};

/// Evaluated by a team in three phases with a barrier after each: write_surface_parts, sweep, visit_shared. The last
/// two call visit(node, force) exactly once for each node; from then on nobody reads its displacement, so that it may
/// be changed there.
class NodalForce {
 public:
  NodalForce(const SolidMesh& mesh, const Material& material, int n_points, const WettedSurface& wetted,
             const std::vector<PressureLoad>& pressures, const std::vector<RigidPlane>& planes, int n_members);

  void write_surface_parts(int member, const double* displacement, const Moment& moment) {
    surface_.write(member, n_members_, displacement, moment.time, moment.fraction, surface_buffer());
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

  /// The internal force alone, by one thread: (n_nodes, 4) [N].
  NodeVectors internal_only(const NodeVectors& displacement);
  /// All forces, by one thread: (n_nodes, 4) [N].
  NodeVectors all(const NodeVectors& displacement, const Moment& moment);

  /// The first element found turned inside out since the last call of forget_inverted, or -1.
  Index inverted_element() const { return inverted_element_; }
  void forget_inverted() { inverted_element_ = -1; }

  double strain_energy() const;                                // at the last moment with energy [J]
  double element_seconds() const { return element_seconds_; }  // that the first member has spent in internal_force [s]
  SurfaceForce& surface() { return surface_; }
  const PlaneContact& contact() const { return surface_.contact(); }
  std::size_t memory_bytes() const;

 private:
  template <class Visit>
  void visit_nodes(Index first, Index last, const Visit& visit) const {
    for (Index n = first; n < last; ++n)
      visit(plan_.visit_node[static_cast<std::size_t>(n)], plan_.sum(n, &buffer_.data()->lane[0]));
  }
  StoredPack* surface_buffer() { return buffer_.data() + plan_.n_element_packs; }
  void compute(int member, const SweepPlan::Chunk& chunk, const double* displacement, const Moment& moment);
  NodeVectors collect(const NodeVectors& displacement, const Moment& moment);
  void note_inverted(Index element);

  Index n_nodes_;
  int n_members_;
  Material material_;
  ElementPacks elements_;
  SurfaceForce surface_;
  SweepPlan plan_;
  std::vector<StoredPack> buffer_;  // parts of forces [N]: of elements, then of the surface
  std::vector<StoredPack> energy_;  // of each element [J], (n element packs)
  std::atomic<Index> inverted_element_{-1};
  double element_seconds_ = 0;
};

}  // namespace couplet::solid
