#pragma once
// The door of this folder: fields travel between the surface of the flow and that of the solid.

#include <string>

#include "coupler/mapping/conservation.hpp"
#include "coupler/mapping/interpolation.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

enum class MappingKind {
  automatic,      // matching where the nodes coincide, otherwise closest face (nearest point if the solid has no faces)
  matching,       // node by node, in any order
  nearest_point,  // each flow node follows the nearest solid node
  closest_face,   // each flow node follows the closest point of the solid's faces
};

std::string name_of(MappingKind kind);

/// Motion goes from solid to flow, force from flow to solid. A field is (n_nodes, n_components); all of a field's
/// components travel alike. With x = X + u the position of the solid's nodes and M the weights (rows sum to 1), the
/// flow's nodes stand at
///   x_flow = M x + gap n(x)
/// where n is the normal of the solid's face that a flow node was projected on and gap its distance from it (0 for
/// matching and nearest_point). Force uses the transpose of the derivative of this map, therefore total force and
/// virtual work agree to round-off for every kind. The moment agrees to round-off wherever the map turns with a rigidly
/// turning solid: matching and closest_face (a flow node that overhangs the solid's surface by more than one face
/// excepted); with nearest_point it misses by distance times force.
class Mapping {
 public:
  /// Surfaces in reference position. Throws SceneError naming the first node without partner (matching), or what is
  /// missing (no nodes; no faces for closest_face).
  Mapping(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid, MappingKind kind);

  MappingKind kind() const { return kind_; }         // the one in use, never automatic
  bool is_identity() const { return is_identity_; }  // fields may be used as they are
  /// Largest distance of a flow node from the point of the solid that it follows, in reference position [m].
  double largest_distance() const { return interpolation_.largest_distance; }

  /// Displacement of the flow's nodes.
  surface::NodeArray displacement_to_flow(const surface::NodeArray& solid_displacement) const;
  /// Velocity (or any rate) of the flow's nodes while the solid is displaced.
  surface::NodeArray velocity_to_flow(const surface::NodeArray& solid_velocity,
                                      const surface::NodeArray& solid_displacement) const;
  /// Nodal forces of the flow carried to the solid's nodes, in the position that solid_displacement gives.
  surface::NodeArray force_to_solid(const surface::NodeArray& flow_force,
                                    const surface::NodeArray& solid_displacement) const;

  /// What the exchange kept, from the fields of both sides as they were used. solid_motion is any motion of the solid
  /// that work is measured for: its velocity, or displacement.
  ConservationError conservation_error(const surface::NodeArray& flow_force, const surface::NodeArray& solid_force,
                                       const surface::NodeArray& solid_displacement,
                                       const surface::NodeArray& solid_motion) const;

 private:
  surface::NodeArray flow_position_;   // (n_flow, 3) reference [m]
  surface::NodeArray solid_position_;  // (n_solid, 3) reference [m]
  MappingKind kind_;
  bool is_identity_ = false;
  Interpolation interpolation_;
};

}  // namespace couplet::coupling
