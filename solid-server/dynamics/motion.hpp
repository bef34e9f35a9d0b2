#pragma once
// The state of a body in motion, and what changes it besides forces.

#include <algorithm>
#include <memory>

#include "proto/surface/surface_mesh.hpp"
#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

struct FactorOrigin;

/// The factors of a tangent with which the next implicit step begins, as what they were made from.
struct KeptFactors {
  /// Null: none. Shared, since it never changes, by the accepted state, the trial state and the solver: no copy a step.
  std::shared_ptr<const FactorOrigin> origin;
  int n_steps = 0, n_iterations = 0;  // that they have served
  bool are_worn = false;              // new ones cost less than going on with them
};

/// The stable step of the central difference method as last estimated, and what has happened since.
struct StepEstimate {
  double stable_step = 0;                           // [s]
  std::shared_ptr<const NodeVectors> displacement;  // where; shared, since it never changes (n_nodes, 4) [m]
  int n_accepted = 0, n_substeps = 0;               // since then: accepted steps, substeps
  int n_unseen = 0;                                 // substeps since the last look at lengths in elements
  double change = 0;                                // of these lengths as last seen, see LengthChange
};

/// Displacement, velocity and force at the same time: the complete state of the central difference method; with the
/// acceleration that of implicit ones.
struct Motion {
  double time = 0;                     // [s]
  NodeVectors displacement, velocity;  // (n_nodes, 4) [m] [m/s]
  NodeVectors force;                   // all forces on the nodes, interface load included (n_nodes, 4) [N]
  surface::NodeArray interface_force;  // (n wetted nodes, 3) [N]
  bool has_interface_force = false;    // false before the first step: its load is then taken as constant
  int n_kicks_done = 0;
  StepEstimate estimate;                       // of the central difference method
  double external_work = 0, damping_work = 0;  // since t = 0, see EnergyLedger; 0 without one [J]
  NodeVectors acceleration;  // of implicit steps (n_nodes, 4) [m/s^2]; without rows: not known yet, or explicit
  int n_halvings = 0;        // of the substep, after iterations that failed
  KeptFactors factors;       // of implicit and static steps
};

/// Force per mass and velocity [1/s]: that of the body, and more of it until the body has settled. And force per
/// stiffness and velocity.
struct Damping {
  double of_body = 0;                    // [1/s]
  double until = 0, while_settling = 0;  // [s] [1/s]
  double stiffness_factor = 0;           // beta [s]

  double at(double time) const { return of_body + (time < until ? while_settling : 0); }
};

/// Velocities that are added once.
struct KickVelocity {
  double time = 0;       // [s]
  NodeVectors velocity;  // (n_nodes, 4) [m/s], zero where a support holds the node
};

/// Rising in time.
inline void sort_kicks(std::vector<KickVelocity>& kicks) {
  std::stable_sort(kicks.begin(), kicks.end(),
                   [](const KickVelocity& a, const KickVelocity& b) { return a.time < b.time; });
}

}  // namespace couplet::solid
