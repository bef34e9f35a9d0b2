#pragma once
// Forces, masses and tangents of a body as implicit and static methods need them.

#include <memory>

#include "solid-server/assembly/skew_part.hpp"
#include "solid-server/assembly/tangent_solver.hpp"
#include "solid-server/dynamics/motion.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/support/prescribed_motion.hpp"

namespace couplet::solid {

/// What a matrix was made from: enough to make the same factors again, to the last bit.
struct FactorOrigin {
  NodeVectors strained, displacement;  // where the internal and the external forces were linearised [m]
  NodeVectors increment;               // (n_nodes, 4), or without rows: the tangent itself [m]
  double time = 0;                     // [s]
  TangentWeights weights;
  double external_stiffness = 0;  // weight of the stiffness of external forces
};

/// What implicit steps of a body cost, and how slowly it can move.
struct ImplicitCost {
  double factorisation_seconds = 0;  // of a tangent, its assembly included [s]
  double iteration_seconds = 0;      // of a residual and a solution [s]
  double lowest_rate = 0;            // of its modes about the motion in hand, an estimate from above [1/s]
};

/// A body between its forces and the linear solver. All members of the team work at each call.
class BodyEquations {
 public:
  BodyEquations(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, const FreeComponents& free,
                HeldMotion held, NodalForce& force, WorkTeam& team);

  const SolidMesh& mesh() const { return mesh_; }
  NodeVectors mass_times(const NodeVectors& vector) const { return tangent_->mass_times_on_all(vector); }
  const HeldMotion& held() const { return held_; }
  NodalForce& force() { return force_; }
  double length() const { return length_; }  // the longest side of the box around the body [m]

  /// All forces, internal ones at `strained`, the others at `displacement`: (n_nodes, 4) [N]. Returns the first
  /// inverted element that a law noticed, or -1.
  Index forces(const NodeVectors& strained, const NodeVectors& displacement, const Moment& moment, NodeVectors& out);
  /// |external forces on free components| at a displacement [N].
  double external_size(const NodeVectors& displacement, const Moment& moment);

  /// Whether something touches at a displacement; whether it touched where forces() was last.
  bool touches_at(const NodeVectors& displacement) {
    return force_.external().contact_total(displacement.data()).force > 0;
  }
  bool is_touching() const { return force_.external().is_touching(); }
  /// Whether surfaces come deeper into contact on the way than they can be followed; see SurfaceContact.
  bool contact_deepens_too_fast(const NodeVectors& from, const NodeVectors& to) {
    return force_.external().surface_contact().deepens_too_fast(from.data(), to.data());
  }

  /// Keeps the free components, or the others.
  NodeVectors free_part(const NodeVectors& vector) const { return vector.cwiseProduct(is_free_); }
  NodeVectors held_part(const NodeVectors& vector) const { return vector - free_part(vector); }

  /// Factors of weights.stiffness K + weights.mass M + external_stiffness (- d external / du), unless they are there
  /// already. Returns the first inverted element or -1; there are no factors then. Throws NumericsError when the matrix
  /// is singular.
  Index factorise(std::shared_ptr<const FactorOrigin> origin);
  void forget_factors() { origin_.reset(); }
  const std::shared_ptr<const FactorOrigin>& origin() const { return origin_; }  // null: no factors
  /// With the symmetric part of the matrix.
  NodeVectors solve(const NodeVectors& rhs) const { return tangent_->solve(rhs); }
  /// With the whole matrix: pressures on surfaces whose rim is free make it unsymmetric. As cheap as `solve` where
  /// there are none.
  NodeVectors solve_unsymmetric(const NodeVectors& rhs) const;
  bool is_symmetric() const { return skew_.is_zero(); }  // the whole matrix
  /// Of the symmetric part.
  int n_negative_pivots() const { return tangent_->n_negative_pivots(); }

  /// New factors over one residual and one solve, by the sizes alone. Measured: 20 for thin leaflets of 38,000 free
  /// components, where factors of nearly flat bodies grow as n^1.5 and solves as n log n.
  double factorisation_cost() const;
  /// What steps of a duration [s] from a motion cost, and the slowest vibration about it; what is slower than some
  /// hundred of them a period counts as rigid. No factors are left.
  ImplicitCost measure(const Motion& motion, double duration);
  double least_factorisation_seconds() const;  // by the fastest cores that there are [s]
  const TangentCost& cost() const { return tangent_->cost(); }
  std::size_t memory_bytes() const;

 private:
  const SolidMesh& mesh_;
  NodalForce& force_;
  WorkTeam& team_;
  HeldMotion held_;
  NodeVectors is_free_;  // 1 or 0 (n_nodes, 4)
  double length_;
  std::unique_ptr<TangentSolver> tangent_;
  SkewPart skew_;                               // of the matrix
  std::shared_ptr<const FactorOrigin> origin_;  // null: no factors
};

}  // namespace couplet::solid
