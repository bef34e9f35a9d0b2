#pragma once
// The central difference method, written so that displacement, velocity and force belong to the same time.

#include <optional>

#include "solid-server/dynamics/energy_ledger.hpp"
#include "solid-server/dynamics/motion.hpp"
#include "solid-server/dynamics/substep_limit.hpp"
#include "solid-server/dynamics/time_integrator.hpp"

namespace couplet::solid {

/// Velocity Verlet with damping in a symmetric splitting [Hairer, Lubich, Wanner 2003], one force a substep, second
/// order:
///   v <- d v + h/2 F/m,  u <- u + h v,  F <- force(u, t + h),  v <- d (v + h/2 F/m),  d = exp(-c h/2).
/// The damping by mass is exact, whatever its size. Damping by stiffness, beta K v, enters as the internal force at
/// u + beta v with the v of the half step: no second evaluation, for the price of a smaller stable step [Belytschko,
/// Liu, Moran 2000, ch. 6]; the strain energy that is reported is that at u + beta v too. The interface load
/// varies linearly in time from the accepted to the given force. A kick is added at the start of the substep that
/// begins nearest to its time. Prescribed nodes follow their displacements exactly at every substep.
///
/// A long step is made in pieces of at most 64 equal substeps. Between them the limit of substeps is looked at, and
/// every law looks for inverted elements.
class CentralDifference : public TimeIntegrator {
 public:
  /// `mass`: (n_nodes) [kg]. `inverse_mass` must outlive this.
  CentralDifference(const SolidMesh& mesh, NodalForce& force, Eigen::VectorXd mass, const NodeVectors& inverse_mass,
                    HeldMotion held, Damping damping, std::vector<KickVelocity> kicks, SubstepLimit limit,
                    WorkTeam& team);

  SubstepLimit& limit() { return limit_; }
  /// From now on steps find the work of loads and damping: a tenth to a fifth of a substep more.
  void keep_ledger() { ledger_.emplace(force_.external(), mass_, inverse_mass_, damping_.stiffness_factor); }
  int n_substeps(const Motion& from, double duration) const;  // that a step takes, if elements keep their lengths

  /// Allocates nothing in substeps. Throws NumericsError naming element and time when an element is turned inside out.
  StepWork advance(const Motion& from, double duration, const surface::NodeArray& interface_force, Motion& to) override;
  NodeVectors mass_times(const NodeVectors& vector) const override { return mass_.asDiagonal() * vector; }
  std::vector<double> support_force(const Motion& motion,
                                    const std::vector<HeldMotion::Component>& held) const override;
  std::size_t memory_bytes() const override;

 private:
  struct Substep {
    double end = 0;                // [s]
    double fraction = 0;           // of the coupling step, at its end
    double damping_factor = 1;     // d
    const double* kick = nullptr;  // added at its start
  };

  /// A part of a coupling step, from one share of it to another.
  struct Piece {
    double begin, duration;           // [s]
    double first_fraction, fraction;  // at its begin; of its duration
    int n_substeps;
  };
  void advance_piece(const Motion& from, const Piece& piece, const double* first_force, Motion& to);
  void refuse_inverted(const Piece& piece) const;
  void plan(const Piece& piece, Motion& to);
  void start(const Motion& from, const double* force, Share nodes, Motion& to);
  bool substep(int member, int k, Motion& to);
  template <bool with_ledger>
  bool substep_with(int member, int k, Motion& to);
  void write_external_parts(int member, const double* displacement, const Moment& moment);
  template <class Visit>
  bool visit_all(int member, const double* displacement, const Moment& moment, const Visit& visit);
  /// Where the internal force is evaluated.
  const double* strained_at(const double* displacement) const {
    return is_strain_damped_ ? strained_.data() : displacement;
  }
  void note_strained(Eigen::Index node, const NodeQuad& displacement, const NodeQuad& velocity);

  void hold(int k, const double* force, Motion& to);
  void note_held(const NodeVectors& velocity);
  double kinetic_energy_of_held(const Motion& motion) const;

  const SolidMesh& mesh_;
  NodalForce& force_;
  Eigen::VectorXd mass_;             // (n_nodes) [kg]
  const NodeVectors& inverse_mass_;  // (n_nodes, 4), 0 where a support holds [1/kg]
  HeldMotion held_;
  Damping damping_;
  std::vector<KickVelocity> kicks_;  // rising in time
  SubstepLimit limit_;
  WorkTeam& team_;
  double start_time_ = 0, h_ = 0;  // of the piece, substep [s]
  bool is_given_up_ = false;       // by the watch; written by member 0 between barriers
  std::vector<Substep> substeps_;
  std::optional<EnergyLedger> ledger_;
  std::vector<double> held_velocity_;  // of prescribed components in the last substep, for the ledger [m/s]
  bool is_strain_damped_;
  NodeVectors strained_;  // u + beta v (n_nodes, 4) [m]; empty without damping by stiffness
};

}  // namespace couplet::solid
