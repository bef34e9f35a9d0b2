#pragma once
// The generalized-alpha method: implicit steps as long as the motion allows.

#include "solid-server/dynamics/newton.hpp"
#include "solid-server/dynamics/time_integrator.hpp"

namespace couplet::solid {

struct ImplicitControl {
  double spectral_radius = 0.8;  // rho_inf in [0, 1]: what a step keeps of the highest frequencies
  double largest_substep = 0;    // [s]; 0: the coupling step
  NewtonControl newton;
};

/// Generalized-alpha [Chung, Hulbert 1993] with the spectral radius rho at infinite frequency:
///   alpha_m = (2 rho - 1)/(rho + 1),  alpha_f = rho/(rho + 1),  gamma = 1/2 - alpha_m + alpha_f,
///   beta = (1 - alpha_m + alpha_f)^2/4,
///   u_1 = u_0 + h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),  v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
///   M (a_m + c v_f) = f(u_f + b v_f, u_f, t_f),  x_f = (1 - alpha_f) x_1 + alpha_f x_0,  x_m likewise with alpha_m.
/// Second order for every rho. The internal force is that of the displacement in between (not the mean of two forces),
/// so that rho = 1 is the implicit midpoint rule, which keeps linear and angular momentum of a free body to the
/// tolerance of the iteration, and the energy bounded. c is damping by mass, b by stiffness. M is the consistent mass.
///
/// The accelerations at the start, and after a kick of a body with damping by stiffness, solve the equation of motion.
/// A step whose iteration fails, or in which surfaces come deeper into contact than they can be followed, is halved, at
/// most ten times; after two successes the steps grow again. Newton's method begins with the extrapolated motion; while
/// something touches it searches along every line, since contact is a potential whose slope has kinks.
///
/// Factors are kept over iterations and steps, and renewed at the start of a step when the last step took more
/// iterations than a step costs on average, the factors included. New ones belong to the extrapolated motion, which the
/// interface force does not change: the coupling iterations of a step share them.
class GeneralizedAlpha : public TimeIntegrator, private NonlinearSystem {
 public:
  GeneralizedAlpha(std::unique_ptr<BodyEquations> body, Damping damping, std::vector<KickVelocity> kicks,
                   ImplicitControl control);

  StepWork advance(const Motion& from, double duration, const surface::NodeArray& interface_force, Motion& to) override;
  NodeVectors mass_times(const NodeVectors& vector) const override { return body_->mass_times(vector); }
  std::vector<double> support_force(const Motion& motion,
                                    const std::vector<HeldMotion::Component>& held) const override;
  std::size_t memory_bytes() const override { return body_->memory_bytes(); }
  const TangentCost& cost() const { return body_->cost(); }

 private:
  /// Displacement, velocity, acceleration at the end of a substep, or in between.
  struct Kinematics {
    NodeVectors u, v, a;
  };

  // The equation of a substep, in the displacement at its end.
  void evaluate(const NodeVectors& u, Residual& residual) override;
  Index factorise(const NodeVectors& u, const NodeVectors& increment) override;
  bool has_factors() const override { return body_->origin() != nullptr; }
  NodeVectors solve(const NodeVectors& rhs) const override { return body_->solve(rhs); }
  int n_negative_pivots() const override { return body_->n_negative_pivots(); }
  bool takes_full_steps() const override { return !body_->is_touching(); }
  double factorisation_cost() const override { return body_->factorisation_cost(); }
  double length() const override { return body_->length(); }

  void add_kicks(Motion& motion, double h);
  void find_acceleration(Motion& motion, double fraction);
  bool substep(Motion& motion, double h, double fraction_start, double fraction_end, StepWork& work,
               std::string& why_not);
  void set_up_substep(const Motion& motion, double h, double fraction_start, double fraction_end);
  bool prepare_factors(const Motion& motion, const NodeVectors& u);
  Kinematics end_of_substep(const NodeVectors& u) const;
  std::shared_ptr<const FactorOrigin> origin_at(const NodeVectors& u, const NodeVectors& increment) const;
  NodeVectors strained(const NodeVectors& u_f, const NodeVectors& v_f) const {
    return u_f + damping_.stiffness_factor * v_f;
  }
  double strained_share() const;  // d strained / d u_1
  TangentWeights weights() const;

  std::unique_ptr<BodyEquations> body_;
  Damping damping_;
  std::vector<KickVelocity> kicks_;  // rising in time
  ImplicitControl control_;
  double alpha_m_, alpha_f_, gamma_, beta_;

  // Of the substep in hand.
  const Motion* start_ = nullptr;
  double h_ = 0, mass_damping_ = 0;                // [s] [1/s]
  Moment moment_;                                  // t_f
  NodeVectors held_velocity_, held_acceleration_;  // of prescribed motions at the end; empty: none
  double external_size_ = 0;                       // |external forces| [N]

  std::shared_ptr<const FactorOrigin> last_new_;  // factors that prepare_factors made last
};

}  // namespace couplet::solid
