#pragma once
// All forces on the nodes of a body at given displacements and time: internal, interface load, prescribed pressures,
// contact.

#include <atomic>

#include "solid-server/assembly/force_gather.hpp"
#include "solid-server/contact/rigid_plane.hpp"
#include "solid-server/element/internal_force.hpp"
#include "solid-server/load/surface_pressure.hpp"
#include "solid-server/mesh/wetted_surface.hpp"

namespace couplet::solid {

/// Evaluated in two phases with a barrier between them: first every element and face writes its parts (write_parts,
/// shared out among the members of a team), then any node can be asked (at).
class NodalForce {
 public:
  NodalForce(const SolidMesh& mesh, const Material& material, int n_points, const WettedSurface& wetted,
             const std::vector<PressureLoad>& pressures, const std::vector<RigidPlane>& planes);

  /// The interface load, (n wetted nodes, 3) [N], varies linearly from `start` at fraction 0 to `end` at fraction 1.
  void set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end);

  /// On all nodes, (n_nodes, 4) [N].
  NodeVectors interface_load_at_start() const;

  struct Moment {
    double time = 0;           // [s]
    double fraction = 0;       // of the coupling step
    bool with_energy = false;  // strain energy is kept, and every law looks for inverted elements
  };

  /// The share of one member. A found inverted element is kept (inverted_element).
  void write_parts(int member, int n_members, const double* displacement, const Moment& moment);

  /// The force on a node [N]; x, y, z, 0.
  [[gnu::always_inline]] NodeQuad at(Index node) const { return gather_.sum(node, &buffer_.data()->lane[0]); }

  /// The same without interface load, pressures and contact, by one thread: (n_nodes, 4) [N].
  NodeVectors internal_only(const NodeVectors& displacement) const;

  /// The first element found turned inside out since the last call of forget_inverted, or -1.
  Index inverted_element() const { return inverted_element_; }
  void forget_inverted() { inverted_element_ = -1; }

  double strain_energy() const;                                // at the last moment with energy [J]
  double element_seconds() const { return element_seconds_; }  // that the first member has spent in internal_force [s]
  const PlaneContact& contact() const { return contact_; }
  std::size_t memory_bytes() const;

 private:
  struct LoadedSurface {
    FacePacks faces;
    std::function<double(double)> pressure;
    std::size_t first_pack = 0;  // of its parts in the buffer
  };

  void note_inverted(Index element);

  Index n_nodes_;
  Material material_;
  ElementPacks elements_;
  std::vector<LoadedSurface> loads_;
  PlaneContact contact_;
  std::size_t contact_first_pack_ = 0, interface_first_pack_ = 0;
  NodeVectors interface_start_, interface_change_;  // (n wetted nodes, 4) [N]
  ForceGather gather_;
  std::vector<StoredPack> buffer_;  // parts of forces [N]
  std::vector<StoredPack> energy_;  // of each element [J], (n element packs)
  std::vector<char> was_touching_;
  std::vector<Index> wetted_node_;
  double element_seconds_ = 0;
  std::atomic<Index> inverted_element_{-1};
};

}  // namespace couplet::solid
