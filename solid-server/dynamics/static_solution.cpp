#include "solid-server/dynamics/static_solution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/sparse_cholesky.hpp"

namespace couplet::solid {

namespace {

constexpr int n_load_halvings_most = 4;
constexpr double largest_jump = 3;        // of a load step, over what the tangent predicts: more is another branch
constexpr double load_difference = 1e-4;  // for the load rate: exact for loads that are linear in the factor

}  // namespace

StepWork StaticSolution::advance(const Motion& from, double duration, const surface::NodeArray& interface_force,
                                 Motion& to) {
  begin(from, duration, interface_force, to);
  StepWork work;
  constexpr int n_ticks = 1 << n_load_halvings_most;
  int n_successes = 0, tick = 0;
  double last_change = std::numeric_limits<double>::max();  // of the displacements in a load step that succeeded
  while (tick < n_ticks) {
    const int length = 1 << (n_load_halvings_most - to.n_halvings);
    const double start = static_cast<double>(tick) / n_ticks, end = static_cast<double>(tick + length) / n_ticks;
    std::string why_not;
    const NodeVectors before = to.displacement;
    bool has_equilibrium = false;
    try {
      has_equilibrium = load_step(start, end, to.displacement, work, why_not);
    } catch (const SingularMatrix& singular) {
      why_not = singular.sentence();
    }
    if (has_equilibrium) {
      tick += length;
      last_change = (to.displacement - before).norm();
      ++work.n_substeps;
      if (++n_successes >= 2 && to.n_halvings > 0 && tick % (2 * length) == 0) --to.n_halvings, n_successes = 0;
      continue;
    }
    n_successes = 0;
    if (to.n_halvings < n_load_halvings_most) {
      ++to.n_halvings;
      continue;
    }
    const std::string where = "solid, t = " + report::text(moment(start).time) + " s";
    const std::string advice = "lower the load, or support the body so that it cannot move freely";
    if (!control_.may_follow_path)
      throw report::NumericsError(
          where, "a load step of " + report::text(duration * (end - start)) + " s finds no equilibrium: " + why_not,
          advice + "; allow the path to be followed by arc length");
    double factor = start;
    ArcLengthControl path = control_.path;
    path.first_load_step = end - start;
    path.longest_first_arc = last_change;
    const PathReport report =
        follow_path(*this, path, to.displacement, factor, 1, [](const PathPoint&) { return true; });
    work.n_iterations += report.n_iterations;
    work.n_factorisations += report.n_factorisations;
    work.n_substeps += report.n_arcs;
    for (const double limit : report.limit_loads) work.limit_loads.push_back(moment(limit).time);
    if (!report.has_reached_load)
      throw report::NumericsError(where,
                                  "neither steps of the load nor its path by arc length reach t = " +
                                      report::text(moment(1).time) + " s: " + why_not + "; " + report.failure,
                                  advice);
    factorise(to.displacement, NodeVectors(0, 4));
    ++work.n_factorisations;
    tick = n_ticks;
    to.n_halvings = 0;
  }
  finish(1, to);
  work.n_negative_pivots = n_negative_pivots();
  to.factors = {body_->origin()};
  return work;
}

PathReport StaticSolution::follow(const Motion& from, double duration, const surface::NodeArray& interface_force,
                                  const ArcLengthControl& control, const std::function<bool(const PathPoint&)>& visit,
                                  Motion& to) {
  begin(from, duration, interface_force, to);
  double factor = 0;
  const PathReport report = follow_path(*this, control, to.displacement, factor, 1, visit);
  finish(factor, to);
  return report;
}

void StaticSolution::begin(const Motion& from, double duration, const surface::NodeArray& interface_force, Motion& to) {
  to = from;
  to.velocity.setZero();
  to.acceleration.resize(0, 4);
  start_time_ = from.time;
  duration_ = duration;
  interface_force_ = interface_force;
  const surface::NodeArray nothing = surface::NodeArray::Zero(interface_force.rows(), 3);
  body_->force().external().set_interface_load(from.has_interface_force ? from.interface_force : nothing,
                                               interface_force);
  at_equilibrium_ = from.factors.origin;
}

/// From an equilibrium at one load factor to the next. False, and u as it was, when there is none.
bool StaticSolution::load_step(double factor_start, double factor_end, NodeVectors& u, StepWork& work,
                               std::string& why_not) {
  int n_negative_before = 0;
  if (at_equilibrium_) {
    body_->factorise(at_equilibrium_);
    n_negative_before = n_negative_pivots();
  } else {
    body_->forget_factors();
  }
  Newton newton(control_.newton);
  NodeVectors end = u;
  set_load(factor_end, end);
  NodeVectors increment = end - u;  // of prescribed motions
  const bool has_tangent = has_factors();
  double predicted = std::numeric_limits<double>::max();  // size of the change
  if (has_tangent) {
    set_load(factor_start, end = u);
    const NodeVectors tangent_step = (factor_end - factor_start) * solve(load_rate(u));
    set_load(factor_end, end);
    end += tangent_step;
    increment = end - u;
    predicted = increment.norm();
  }
  const NewtonReport report =
      newton.solve(*this, end, increment, has_tangent ? Newton::Factors::of_the_increment : Newton::Factors::unknown);
  work.n_iterations += report.n_iterations;
  work.n_factorisations += report.n_factorisations;
  if (!report.has_converged()) {
    why_not = report.inverted_element >= 0
                  ? body_->mesh().describe_element(report.inverted_element) + " at rest is turned inside out"
                  : report.sentence();
    return false;
  }
  NodeVectors force;
  Moment with_energy = moment(factor_end);
  with_energy.with_energy = true;  // every law looks for inverted elements
  if (const Index inverted = body_->forces(end, end, with_energy, force); inverted >= 0) {
    why_not = body_->mesh().describe_element(inverted) + " at rest is turned inside out";
    return false;
  }
  if ((end - u).norm() > largest_jump * predicted) {
    why_not = "the equilibrium that is found lies more than three times as far away as the tangent says";
    return false;
  }
  if (body_->contact_deepens_too_fast(u, end)) {
    why_not = "surfaces in contact come closer than they can be followed";
    return false;
  }
  // The factors with which the next step begins, and what they tell of this one.
  if (factorise(end, NodeVectors(0, 4)) >= 0) return false;
  ++work.n_factorisations;
  // Under pressures on free rims the symmetric part tells nothing: a strip that an end moment rolls up is stable.
  if (body_->is_symmetric() && n_negative_pivots() > n_negative_before) {
    why_not = "the equilibrium that is found is not stable";
    return false;
  }
  at_equilibrium_ = body_->origin();
  work.residual = std::max(work.residual, report.residual);
  u.swap(end);
  return true;
}

/// Force, energy and loads at the end of a step.
void StaticSolution::finish(double factor, Motion& to) {
  set_load(factor, to.displacement);
  Moment end = moment(factor);
  end.with_energy = true;
  body_->forces(to.displacement, to.displacement, end, to.force);
  to.time = end.time;
  if (!to.has_interface_force) to.interface_force.setZero();
  to.interface_force += factor * (interface_force_ - to.interface_force);
  to.has_interface_force = true;
}

void StaticSolution::set_load(double factor, NodeVectors& u) {
  factor_ = factor;
  hold(factor, u);
  external_size_ = body_->external_size(u, moment(std::clamp(factor, 0.0, 1.0)));
}

void StaticSolution::hold(double factor, NodeVectors& u) {
  const auto hold_at = [&](double known, NodeVectors& moved) {
    body_->held().check_finite(moment(known).time);
    body_->held().hold(moment(known).time, moved);
  };
  if (is_in_step(factor)) return hold_at(factor, u);
  NodeVectors end = u;
  hold_at(0, u);
  hold_at(1, end);
  u += factor * (end - u);
}

/// f(0) + factor (f(1) - f(0)) outside the step: forces are linear in loads.
Index StaticSolution::forces(const NodeVectors& u, double factor, NodeVectors& force) {
  if (is_in_step(factor)) return body_->forces(u, u, moment(factor), force);
  NodeVectors end;
  const Index inverted = body_->forces(u, u, moment(0), force);
  body_->forces(u, u, moment(1), end);
  force += factor * (end - force);
  return inverted;
}

void StaticSolution::evaluate(const NodeVectors& u, Residual& residual) {
  NodeVectors force;
  residual.inverted_element = forces(u, factor_, force);
  residual.value = body_->free_part(force);
  residual.scale = std::max(external_size_, body_->held_part(force).norm());
}

NodeVectors StaticSolution::load_rate(const NodeVectors& u) {
  NodeVectors here, beyond, moved = u;
  forces(u, factor_, here);
  hold(factor_ + load_difference, moved);
  forces(moved, factor_ + load_difference, beyond);
  return body_->free_part(beyond - here) / load_difference;
}

Index StaticSolution::factorise(const NodeVectors& u, const NodeVectors& increment) {
  return body_->factorise(std::make_shared<const FactorOrigin>(
      FactorOrigin{u, u, increment, moment(std::clamp(factor_, 0.0, 1.0)).time, {1, 0}, 1}));
}

std::vector<double> StaticSolution::support_force(const Motion& motion,
                                                  const std::vector<HeldMotion::Component>& held) const {
  std::vector<double> force;
  for (const auto& [node, axis] : held) force.push_back(-motion.force(node, axis));
  return force;
}

}  // namespace couplet::solid
