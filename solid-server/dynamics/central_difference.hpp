#pragma once
// The central difference method, written so that displacement, velocity and force belong to the same time.

#include "solid-server/dynamics/motion.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

/// Velocity Verlet with damping in a symmetric splitting [Hairer, Lubich, Wanner 2003], one force a substep, second
/// order:
///   v <- d v + h/2 F/m,  u <- u + h v,  F <- force(u, t + h),  v <- d (v + h/2 F/m),  d = exp(-c h/2).
/// The damping by mass is exact, whatever its size. Damping by stiffness, beta K v, enters as the internal force at
/// u + beta v with the v of the half step: no second evaluation, for the price of a smaller stable step [Belytschko,
/// Liu, Moran 2000, ch. 6]; the strain energy that is reported is that at u + beta v too. The interface load
/// varies linearly in time from the accepted to the given force. A kick is added at the start of the substep that
/// begins nearest to its time.
class CentralDifference {
 public:
  CentralDifference(NodalForce& force, NodeVectors inverse_mass, Damping damping, std::vector<KickVelocity> kicks,
                    WorkTeam& team);

  /// From one motion to another in equal substeps. Allocates nothing in the substeps. Throws NumericsError naming
  /// element and time when an element is turned inside out.
  void advance(const Motion& from, double duration, int n_substeps, const surface::NodeArray& interface_force,
               Motion& to);

 private:
  struct Substep {
    double end = 0;                // [s]
    double damping_factor = 1;     // d
    const double* kick = nullptr;  // added at its start
  };

  void plan(const Motion& from, double duration, int n_substeps, Motion& to);
  void start(const Motion& from, const double* force, Share nodes, Motion& to);
  bool substep(int member, int k, Motion& to);
  template <class Visit>
  bool visit_all(int member, const double* displacement, const Moment& moment, const Visit& visit);
  /// Where the internal force is evaluated.
  const double* strained_at(const double* displacement) const {
    return is_strain_damped_ ? strained_.data() : displacement;
  }
  void note_strained(Eigen::Index node, const NodeQuad& displacement, const NodeQuad& velocity);

  NodalForce& force_;
  NodeVectors inverse_mass_;  // (n_nodes, 4), 0 where a support holds [1/kg]
  Damping damping_;
  std::vector<KickVelocity> kicks_;  // rising in time
  WorkTeam& team_;
  double h_ = 0;  // substep [s]
  std::vector<Substep> substeps_;
  bool is_strain_damped_;
  NodeVectors strained_;  // u + beta v (n_nodes, 4) [m]; empty without damping by stiffness
};

}  // namespace couplet::solid
