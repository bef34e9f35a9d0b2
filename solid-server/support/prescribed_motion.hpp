#pragma once
// Nodes that are moved as the scene says.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// One component of the displacement of all nodes of a surface, a node set or a marker.
struct PrescribedMotion {
  std::string nodes;
  int axis = 0;
  std::function<double(const Eigen::Vector3d& position, double time)> displacement;  // position at rest [m] [s] -> [m]
};

/// What prescribed motions make of the components that they hold. A component that two motions name follows the first.
class HeldMotion {
 public:
  HeldMotion() = default;
  /// Throws SceneError for an unknown name.
  HeldMotion(const SolidMesh& mesh, const std::vector<PrescribedMotion>& motions);

  struct Component {
    Index node = 0;
    int axis = 0;
  };
  const std::vector<Component>& components() const { return components_; }
  std::optional<std::size_t> number_of(const Component& component) const;  // among them; empty: it is none of them
  bool is_empty() const { return components_.empty(); }

  double displacement(std::size_t n, double time) const;  // of component n [m]
  /// Central differences over `step` [s], so that a velocity belongs to a step that follows the displacements.
  double velocity(std::size_t n, double time, double step) const;
  double acceleration(std::size_t n, double time, double step) const;

  /// Throws NumericsError when a displacement at that time is no finite number.
  void check_finite(double time) const;

  /// Throws SceneError when a displacement at t = 0 is not within `negligible` [m] of 0: with inertia a jump is a blow
  /// without end.
  void refuse_jump_at_start(double negligible) const;

  /// Sets the held components of the displacements.
  void hold(double time, NodeVectors& displacement) const;
  /// Sets those of velocities.
  void hold_velocity(double time, double step, NodeVectors& velocity) const;
  void hold_acceleration(double time, double step, NodeVectors& acceleration) const;

 private:
  std::vector<Component> components_;      // rising in node and axis
  std::vector<Eigen::Vector3d> position_;  // at rest, of each component's node [m]
  std::vector<std::size_t> motion_;        // of each component
  std::vector<PrescribedMotion> motions_;
};

}  // namespace couplet::solid
