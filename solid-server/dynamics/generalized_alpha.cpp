#include "solid-server/dynamics/generalized_alpha.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/sparse_cholesky.hpp"

namespace couplet::solid {

namespace {

constexpr int n_halvings_most = 10;

bool are_equal(const FactorOrigin& a, const FactorOrigin& b) {
  return a.time == b.time && a.external_stiffness == b.external_stiffness &&
         a.weights.stiffness == b.weights.stiffness && a.weights.mass == b.weights.mass && a.strained == b.strained &&
         a.displacement == b.displacement && a.increment == b.increment;
}

constexpr const char* contact_sentence = "surfaces in contact come closer than they can be followed";

/// After one more step: the factors are worn when it cost more than a step has cost on average, themselves included.
KeptFactors served(KeptFactors factors, int n_iterations, double cost) {
  ++factors.n_steps;
  factors.n_iterations += n_iterations;
  factors.are_worn = n_iterations > (cost + factors.n_iterations) / factors.n_steps;
  return factors;
}

}  // namespace

GeneralizedAlpha::GeneralizedAlpha(std::unique_ptr<BodyEquations> body, Damping damping,
                                   std::vector<KickVelocity> kicks, ImplicitControl control)
    : body_(std::move(body)), damping_(damping), kicks_(std::move(kicks)), control_(control) {
  const double rho = control.spectral_radius;
  alpha_m_ = (2 * rho - 1) / (rho + 1);
  alpha_f_ = rho / (rho + 1);
  gamma_ = 0.5 - alpha_m_ + alpha_f_;
  beta_ = std::pow(1 - alpha_m_ + alpha_f_, 2) / 4;
  sort_kicks(kicks_);
  for (KickVelocity& kick : kicks_) kick.velocity = body_->free_part(kick.velocity);
}

StepWork GeneralizedAlpha::advance(const Motion& from, double duration, const surface::NodeArray& interface_force,
                                   Motion& to) {
  body_->force().external().set_interface_load(from.has_interface_force ? from.interface_force : interface_force,
                                               interface_force);

  to = from;
  if (to.acceleration.rows() == 0) find_acceleration(to, 0);
  const int n_wanted = control_.largest_substep > 0 ? n_equal_steps(duration, control_.largest_substep) : 1;
  const long n_ticks = static_cast<long>(n_wanted) << n_halvings_most;  // of the shortest substep
  StepWork work;
  int n_successes = 0;
  for (long tick = 0; tick < n_ticks;) {
    const long length = 1L << (n_halvings_most - to.n_halvings);
    const auto fraction = [&](long t) { return static_cast<double>(t) / static_cast<double>(n_ticks); };
    to.time = from.time + duration * fraction(tick);
    std::string why_not;
    if (substep(to, duration * fraction(length), fraction(tick), fraction(tick + length), work, why_not)) {
      tick += length;
      ++work.n_substeps;
      if (++n_successes >= 2 && to.n_halvings > 0 && tick % (2 * length) == 0) --to.n_halvings, n_successes = 0;
      continue;
    }
    n_successes = 0;
    if (++to.n_halvings > n_halvings_most)
      throw report::NumericsError(
          "solid, t = " + report::text(to.time) + " s",
          "an implicit substep of " + report::text(duration * fraction(length)) + " s has no solution: " + why_not,
          "check the loads; lower time.step; solid.time_integration.method: CENTRAL_DIFFERENCE "
          "takes short steps anyway");
  }
  to.time = from.time + duration;
  to.interface_force = interface_force;
  to.has_interface_force = true;
  return work;
}

/// One substep from a motion to itself at the end. False, and the motion as it was, when there is no solution.
bool GeneralizedAlpha::substep(Motion& motion, double h, double fraction_start, double fraction_end, StepWork& work,
                               std::string& why_not) {
  const Motion kept = motion;
  const double begin = motion.time;
  add_kicks(motion, h);
  if (motion.n_kicks_done > kept.n_kicks_done && damping_.stiffness_factor > 0)
    find_acceleration(motion, fraction_start);  // its jump is not known otherwise
  const Motion start = motion;
  set_up_substep(start, h, fraction_start, fraction_end);

  Newton newton(control_.newton);
  NewtonReport report;
  bool are_new = false;
  const auto iterate_from = [&](NodeVectors& u) {
    body_->held().hold(begin + h, u);
    are_new = prepare_factors(start, u);
    work.n_factorisations += are_new;
    report = newton.solve(*this, u, u - start.displacement,
                          are_new ? Newton::Factors::of_this_start : Newton::Factors::unknown);
    are_new = are_new || report.n_factorisations > 0;
    work.n_iterations += report.n_iterations;
    work.n_factorisations += report.n_factorisations;
    work.residual = std::max(work.residual, report.has_converged() ? report.residual : 0);
    if (!report.has_converged())
      why_not = report.inverted_element >= 0
                    ? body_->mesh().describe_element(report.inverted_element) + " at rest is turned inside out"
                    : report.sentence();
    return report.has_converged();
  };
  const auto solve_from = [&](NodeVectors& u) {
    try {
      return iterate_from(u);
    } catch (const SingularMatrix& singular) {
      why_not = singular.sentence();
      return false;
    }
  };
  NodeVectors u = start.displacement + h * start.velocity;
  if (body_->contact_deepens_too_fast(start.displacement, u)) {  // no solution is looked for, since it would be too
    work.is_cut_for_contact = true;
    why_not = contact_sentence;
    motion = kept;
    return false;
  }
  // Contact changes the acceleration from step to step: there the velocity alone foretells more.
  if (!body_->touches_at(start.displacement)) u += h * h / 2 * start.acceleration;
  bool is_solved = solve_from(u);
  if (!is_solved) {
    u = start.displacement;
    is_solved = solve_from(u);
  }
  if (is_solved && body_->contact_deepens_too_fast(start.displacement, u)) {
    work.is_cut_for_contact = true;
    why_not = contact_sentence;
    is_solved = false;
  }
  if (is_solved) {
    Kinematics end = end_of_substep(u);
    const Index inverted = body_->forces(strained(end.u, end.v), end.u, {begin + h, fraction_end, true}, motion.force);
    if (inverted < 0) {
      motion.displacement.swap(end.u);
      motion.velocity.swap(end.v);
      motion.acceleration.swap(end.a);
      motion.time = begin + h;
      motion.factors = served(are_new ? KeptFactors{body_->origin()} : start.factors, report.n_iterations,
                              body_->factorisation_cost());
      return true;
    }
    why_not = body_->mesh().describe_element(inverted) + " at rest is turned inside out";
  }
  motion = kept;
  return false;
}

/// Those whose time is nearest to the start of the substep.
void GeneralizedAlpha::add_kicks(Motion& motion, double h) {
  for (; static_cast<std::size_t>(motion.n_kicks_done) < kicks_.size(); ++motion.n_kicks_done) {
    const KickVelocity& kick = kicks_[static_cast<std::size_t>(motion.n_kicks_done)];
    if (kick.time > motion.time + h / 2) return;
    motion.velocity += kick.velocity;
    motion.acceleration -= damping_.at(motion.time) * kick.velocity;  // M a + c M v = f
  }
}

/// M (a + c v) = f.
void GeneralizedAlpha::find_acceleration(Motion& motion, double fraction) {
  NodeVectors force;
  body_->held().check_finite(motion.time);
  body_->held().hold(motion.time, motion.displacement);
  body_->forces(strained(motion.displacement, motion.velocity), motion.displacement, {motion.time, fraction, false},
                force);
  motion.acceleration = NodeVectors::Zero(force.rows(), 4);
  force = body_->free_part(force);
  if (!force.isZero(0)) {
    const Index inverted = body_->factorise(std::make_shared<const FactorOrigin>(
        FactorOrigin{motion.displacement, motion.displacement, NodeVectors(0, 4), motion.time, {0, 1}, 0}));
    if (inverted >= 0)
      throw report::NumericsError("solid, t = " + report::text(motion.time) + " s",
                                  body_->mesh().describe_element(inverted) + " at rest is turned inside out",
                                  "check the prescribed motions: they begin with a jump");
    motion.acceleration = body_->solve(force);
    body_->forget_factors();
  }
  motion.acceleration -= damping_.at(motion.time) * motion.velocity;
}

void GeneralizedAlpha::set_up_substep(const Motion& start, double h, double fraction_start, double fraction_end) {
  start_ = &start;
  h_ = h;
  const double end = start.time + h;
  moment_.time = (1 - alpha_f_) * end + alpha_f_ * start.time;
  moment_.fraction = (1 - alpha_f_) * fraction_end + alpha_f_ * fraction_start;
  mass_damping_ = damping_.at(moment_.time);
  if (!body_->held().is_empty()) {
    for (const double time : {end, end + h / 2, end + h}) body_->held().check_finite(time);  // what is used below
    held_velocity_ = held_acceleration_ = NodeVectors::Zero(start.displacement.rows(), 4);
    body_->held().hold_velocity(end, h, held_velocity_);
    body_->held().hold_acceleration(end, h, held_acceleration_);
  }
  external_size_ = body_->external_size(start.displacement, moment_);
}

/// The factors that the motion keeps, or new ones when they are worn or belong to another length of step. True: new.
bool GeneralizedAlpha::prepare_factors(const Motion& motion, const NodeVectors& u) {
  const auto& kept = motion.factors.origin;
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-3 * std::abs(a); };
  const TangentWeights now = weights();
  if (kept && !motion.factors.are_worn && !differ(now.mass, kept->weights.mass) &&
      !differ(now.stiffness, kept->weights.stiffness)) {
    body_->factorise(kept);
    return false;
  }
  auto origin = origin_at(u, u - start_->displacement);
  if (!last_new_ || !are_equal(*last_new_, *origin)) last_new_ = origin;
  return body_->factorise(last_new_) < 0;
}

GeneralizedAlpha::Kinematics GeneralizedAlpha::end_of_substep(const NodeVectors& u) const {
  Kinematics end;
  end.u = u;
  end.a = (u - start_->displacement - h_ * start_->velocity) / (beta_ * h_ * h_) -
          (0.5 - beta_) / beta_ * start_->acceleration;
  end.v = start_->velocity + h_ * ((1 - gamma_) * start_->acceleration + gamma_ * end.a);
  for (const auto& [node, axis] : body_->held().components()) {
    end.v(node, axis) = held_velocity_(node, axis);
    end.a(node, axis) = held_acceleration_(node, axis);
  }
  return end;
}

void GeneralizedAlpha::evaluate(const NodeVectors& u, Residual& residual) {
  const Kinematics end = end_of_substep(u);
  const NodeVectors u_f = (1 - alpha_f_) * end.u + alpha_f_ * start_->displacement;
  const NodeVectors v_f = (1 - alpha_f_) * end.v + alpha_f_ * start_->velocity;
  const NodeVectors a_m = (1 - alpha_m_) * end.a + alpha_m_ * start_->acceleration;
  NodeVectors force;
  residual.inverted_element = body_->forces(strained(u_f, v_f), u_f, moment_, force);
  const NodeVectors inertia = body_->mass_times(a_m + mass_damping_ * v_f);
  residual.value = body_->free_part(force - inertia);
  residual.scale =
      std::max({external_size_, body_->free_part(inertia).norm(), body_->held_part(force - inertia).norm()});
}

/// d u_f / d u_1 + b d v_f / d u_1.
double GeneralizedAlpha::strained_share() const {
  return (1 - alpha_f_) * (1 + damping_.stiffness_factor * gamma_ / (beta_ * h_));
}

TangentWeights GeneralizedAlpha::weights() const {
  return {strained_share(),
          (1 - alpha_m_) / (beta_ * h_ * h_) + mass_damping_ * (1 - alpha_f_) * gamma_ / (beta_ * h_)};
}

Index GeneralizedAlpha::factorise(const NodeVectors& u, const NodeVectors& increment) {
  return body_->factorise(origin_at(u, increment));
}

std::shared_ptr<const FactorOrigin> GeneralizedAlpha::origin_at(const NodeVectors& u,
                                                                const NodeVectors& increment) const {
  const Kinematics end = end_of_substep(u);
  const NodeVectors u_f = (1 - alpha_f_) * end.u + alpha_f_ * start_->displacement;
  const NodeVectors v_f = (1 - alpha_f_) * end.v + alpha_f_ * start_->velocity;
  return std::make_shared<const FactorOrigin>(
      FactorOrigin{strained(u_f, v_f), u_f, strained_share() * increment, moment_.time, weights(), 1 - alpha_f_});
}

std::vector<double> GeneralizedAlpha::support_force(const Motion& motion,
                                                    const std::vector<HeldMotion::Component>& held) const {
  NodeVectors inertia = NodeVectors::Zero(motion.force.rows(), 4);
  if (motion.acceleration.rows() > 0)
    inertia = body_->mass_times(motion.acceleration + damping_.at(motion.time) * motion.velocity);
  std::vector<double> force;
  for (const auto& [node, axis] : held) force.push_back(inertia(node, axis) - motion.force(node, axis));
  return force;
}

}  // namespace couplet::solid
