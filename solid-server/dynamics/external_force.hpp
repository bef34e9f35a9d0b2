#pragma once
// What acts on a body from outside: the interface load, prescribed loads, rigid planes.

#include "solid-server/assembly/force_part.hpp"
#include "solid-server/contact/rigid_plane.hpp"
#include "solid-server/load/dead_load.hpp"
#include "solid-server/load/pressure_stiffness.hpp"
#include "solid-server/load/surface_pressure.hpp"
#include "solid-server/mesh/wetted_surface.hpp"

namespace couplet::solid {

/// Loads that a scene prescribes.
struct PrescribedLoads {
  std::vector<PressureLoad> pressures;
  std::vector<DeadLoad> dead;
};

class ExternalForce {
 public:
  ExternalForce(const SolidMesh& mesh, const WettedSurface& wetted, PrescribedLoads loads,
                const std::vector<RigidPlane>& planes);

  /// The parts that write() fills; `start` is counted from the start of its buffer.
  const std::vector<ForcePart>& parts() const { return parts_; }
  std::size_t n_packs() const { return n_packs_; }  // size of the buffer
  bool is_empty() const { return n_packs_ == 0; }

  /// The interface load, (n wetted nodes, 3) [N], varies linearly from `start` at fraction 0 to `end` at fraction 1.
  void set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end);
  /// At fraction 0, on all nodes, (n_nodes, 4) [N].
  NodeVectors interface_load_at_start() const;

  /// The share of one member of a team. `displacement` is a NodeVectors array [m].
  void write(int member, int n_members, const double* displacement, double time, double fraction, StoredPack* buffer);

  /// - d force / du of pressures and contact, for each pair of nodes.
  void add_stiffness(const NodeVectors& displacement, double time, const TakeStiffness& take) const;

  const PlaneContact& contact() const { return contact_; }

 private:
  struct PressedSurface {
    FacePacks faces;
    std::function<double(double)> pressure;
    std::size_t first_pack = 0;  // of its parts in the buffer
  };
  struct PlacedLoad {
    DeadLoad load;
    std::size_t first_pack = 0;
  };

  void add_face_parts(const FacePacks& packs, const std::vector<FaceNodes>& faces);
  std::size_t add_node_parts(const std::vector<Index>& nodes);

  Index n_nodes_;
  std::vector<PressedSurface> pressures_;
  std::vector<PlacedLoad> dead_;
  PlaneContact contact_;
  std::size_t contact_first_pack_ = 0, interface_first_pack_ = 0;
  std::vector<char> was_touching_;
  std::vector<Index> wetted_node_;
  NodeVectors interface_start_, interface_change_;  // (n wetted nodes, 4) [N]
  std::vector<ForcePart> parts_;
  std::size_t n_packs_ = 0;
};

}  // namespace couplet::solid
