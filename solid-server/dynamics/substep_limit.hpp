#pragma once
// How long the substeps of the central difference method may be, while the body deforms.

#include "solid-server/dynamics/length_change.hpp"
#include "solid-server/dynamics/motion.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

struct StepControl {
  double safety = 0.9;         // substep over the estimated stable step
  double largest_substep = 0;  // [s]; 0: no other limit
  int estimate_every = 1000;   // accepted steps between two estimates at most
};

/// The stable step is estimated at the start, every `estimate_every` accepted steps, and when lengths in elements have
/// changed since. Every some substeps the body is looked at. Changes up to 0.6 (1 - safety), 6 % by default, are left
/// to the safety. Beyond that it is estimated again, but for laws without fibres not sooner than 1000 substeps after
/// the last estimate, which bounds the cost to some per cent; in between substeps become shorter with the square of the
/// change c,
///   h <= safety h_stable ((1 + 0.6 (1 - safety)) / (1 + c))^2,
/// which is below the stable step of neo-Hookean, Mooney-Rivlin and Saint Venant-Kirchhoff elements in stretch,
/// compression and shear. A change of 25 % never waits.
class SubstepLimit {
 public:
  /// The references must outlive this.
  SubstepLimit(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, NodalForce& force,
               const NodeVectors& inverse_mass, double stiffness_damping, const StepControl& control, WorkTeam& team);

  /// The longest substep [s].
  double largest(const StepEstimate& estimate) const;
  /// The stable step there, (n_nodes, 4) [m].
  StepEstimate estimate_at(const NodeVectors& displacement);
  /// Where a state stands after substeps: estimates again when that is due.
  void look(const NodeVectors& displacement, StepEstimate& estimate);
  /// After every accepted step: likewise.
  void accept(const NodeVectors& displacement, StepEstimate& estimate);

  /// Substeps between two looks: a look costs as much as a fifth to a half of a substep.
  static constexpr int n_between_looks = 64;
  std::size_t memory_bytes() const { return length_change_.memory_bytes(); }

 private:
  double free_change() const;

  NodalForce& force_;
  const NodeVectors& inverse_mass_;
  double stiffness_damping_;
  StepControl control_;
  WorkTeam& team_;
  LengthChange length_change_;
  double smallest_length_;       // [m]
  double contact_rate_squared_;  // bound of contact's part of omega_max^2 [1/s^2]
  bool may_wait_;                // no law has fibres, whose stiffness may grow faster than lengths
};

}  // namespace couplet::solid
