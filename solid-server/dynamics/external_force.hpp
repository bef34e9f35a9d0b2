#pragma once
// What acts on a body from outside its elements: the interface load, prescribed loads, contact.

#include <optional>

#include "solid-server/assembly/force_part.hpp"
#include "solid-server/contact/rigid_plane.hpp"
#include "solid-server/contact/surface_contact.hpp"
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
  /// Contact pairs are complete: see contact/penalty_stiffness.
  ExternalForce(const SolidMesh& mesh, const WettedSurface& wetted, PrescribedLoads loads,
                const std::vector<RigidPlane>& planes, std::vector<ContactPair> pairs = {});

  /// The parts that write() fills; `start` is counted from the start of its buffer.
  const std::vector<ForcePart>& parts() const { return parts_; }
  /// Those of loads, as far as contact leaves them: all without contact, and what contact cancels of the interface
  /// load.
  std::vector<ForcePart> load_parts() const;
  std::size_t n_packs() const { return n_packs_; }  // size of the buffer
  bool is_empty() const { return n_packs_ == 0; }

  /// The interface load, (n wetted nodes, 3) [N], varies linearly from `start` at fraction 0 to `end` at fraction 1.
  void set_interface_load(const surface::NodeArray& start, const surface::NodeArray& end);
  /// At fraction 0, on all nodes, (n_nodes, 4) [N].
  NodeVectors interface_load_at_start() const;

  /// Before write(): contact of surfaces is looked for by one member, then measured by all, with a barrier after each.
  bool has_surface_contact() const { return !surface_contact_.is_empty(); }
  void search_contact(const double* displacement) { surface_contact_.search(displacement); }
  void find_gaps(int member, int n_members) { surface_contact_.find_gaps(member, n_members); }

  /// The share of one member of a team. `displacement` is a NodeVectors array [m].
  void write(int member, int n_members, const double* displacement, double time, double fraction, StoredPack* buffer);

  const std::vector<PlaneContact>& plane_contacts() const { return planes_; }
  SurfaceContact& surface_contact() { return surface_contact_; }

  struct ContactTotal {
    double energy = 0;                        // [J]
    double force = 0;                         // of rigid planes on bodies and of bodies on each other [N]
    std::optional<double> smallest_distance;  // as in SurfaceContact::Total [m]; absent without contact of surfaces
  };
  ContactTotal contact_total(const double* displacement);
  bool is_touching() const;  // where write() was last
  /// For each node, what contact adds to omega_max^2 times its mass at most [N/m].
  Eigen::VectorXd contact_stiffness_bound() const;
  /// - d force / du of pressures and contact, for each pair of nodes. `take_rim` is given again what pressures have on
  /// the rims of their surfaces: all that may be unsymmetric.
  void add_stiffness(const NodeVectors& displacement, double time, const TakeStiffness& take,
                     const TakeStiffness& take_rim);

 private:
  struct PressedSurface {
    FacePacks faces;
    std::function<double(double)> pressure;
    std::size_t first_pack = 0;  // of its parts in the buffer
    std::vector<Index> rim;      // nodes, rising
  };
  struct PlacedLoad {
    DeadLoad load;
    std::size_t first_pack = 0;
  };

  void add_planes(const SolidMesh& mesh, const WettedSurface& wetted, const std::vector<RigidPlane>& planes);
  void write_interface_load(int member, int n_members, double fraction, StoredPack* buffer);
  void add_face_parts(const FacePacks& packs, const std::vector<FaceNodes>& faces);
  std::size_t add_node_parts(const std::vector<Index>& nodes);
  void add_cancelled_parts();

  Index n_nodes_;
  std::vector<PressedSurface> pressures_;
  std::vector<PlacedLoad> dead_;
  std::vector<PlaneContact> planes_;
  std::vector<std::size_t> plane_first_pack_;
  std::vector<std::vector<char>> was_touching_;  // of each plane
  SurfaceContact surface_contact_;
  std::size_t surface_contact_first_pack_ = 0, interface_first_pack_ = 0;
  std::vector<Index> wetted_number_;  // of each contact node; -1: not wetted
  std::vector<Index> wetted_node_;
  NodeVectors interface_start_, interface_change_;  // (n wetted nodes, 4) [N]
  std::vector<ForcePart> parts_;
  std::size_t first_contact_part_ = 0, last_contact_part_ = 0;
  std::vector<ForcePart> cancelled_;  // a second record of what the parts of contact cancel of the interface load
  std::size_t n_packs_ = 0;
};

}  // namespace couplet::solid
