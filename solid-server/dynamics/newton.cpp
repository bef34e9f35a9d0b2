#include "solid-server/dynamics/newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr std::size_t n_pairs_most = 12;
constexpr int n_shortenings_most = 8;
constexpr int n_searches_most = 6;
constexpr int n_growing_most = 4;               // corrections that grow one after another, before it is given up
constexpr double worst_contraction = 0.9;       // of kept factors
constexpr int n_iterations_of_new_factors = 2;  // that follow new factors near a solution, besides their own
constexpr double relative_round_off = 1e-9, round_off_of_length = 1e-13;
constexpr double wanted_decrease = 0.8;  // of d . r, beyond which a shorter step is looked for [Crisfield 1991, 9.2]

double dot(const NodeVectors& a, const NodeVectors& b) {
  return a.cwiseProduct(b).sum();
}

/// Further iterations that a contraction needs to bring the residual down to its tolerance.
double n_iterations_left(double residual, double tolerance, double contraction) {
  return std::log(std::max(residual / tolerance, 1.0)) / -std::log(contraction);
}

/// u + s d with s in (0, 1] such that no element is inverted and, if asked for, d . r is small.
class Step {
 public:
  Step(NonlinearSystem& system, const NodeVectors& u, const NodeVectors& d) : system_(system), u_(u), d_(d) {}

  bool try_length(double s) {
    length_ = s;
    end_ = u_ + s * d_;
    system_.evaluate(end_, residual_);
    return residual_.inverted_element < 0 && residual_.value.allFinite();
  }
  double slope() const { return dot(d_, residual_.value); }  // minus the change of energy with s

  bool halve_until_valid() {
    double s = 1;
    for (int n = 0; n <= n_shortenings_most; ++n, s /= 2)
      if (try_length(s)) return true;
    return false;
  }

  /// Regula falsi on the slope, as modified by Illinois, between 0 and the length tried last.
  void search(double slope_at_start) {
    double low = 0, high = length_, at_low = slope_at_start, at_high = slope();
    if (!(at_low > 0) || at_high > 0) return;  // not a minimum that lies between
    for (int n = 0; n < n_searches_most && std::abs(slope()) > wanted_decrease * slope_at_start; ++n) {
      const double s = std::clamp((low * at_high - high * at_low) / (at_high - at_low), low + 0.05 * (high - low),
                                  high - 0.05 * (high - low));
      if (!try_length(s)) {  // between two valid lengths, yet not valid itself
        try_length(high);
        return;
      }
      if (slope() < 0) {
        high = s, at_high = slope();
        at_low /= 2;
      } else {
        low = s, at_low = slope();
        at_high /= 2;
      }
    }
  }

  double length() const { return length_; }
  NodeVectors& end() { return end_; }
  NonlinearSystem::Residual& residual() { return residual_; }

 private:
  NonlinearSystem& system_;
  const NodeVectors &u_, &d_;
  double length_ = 1;
  NodeVectors end_;
  NonlinearSystem::Residual residual_;
};

}  // namespace

std::string NewtonReport::sentence() const {
  const std::string after = " after " + std::to_string(n_iterations) + " iterations and " +
                            std::to_string(n_factorisations) + " factorisations";
  switch (outcome) {
    case NewtonOutcome::converged:
      return "converged" + after;
    case NewtonOutcome::too_many_iterations:
      return "the forces are out of balance by " + report::text(residual) + " of their size" + after;
    case NewtonOutcome::diverged:
      return "the corrections grow" + after;
    case NewtonOutcome::not_finite:
      return "the forces are no finite numbers" + after;
    case NewtonOutcome::inverted_element:
      return "element " + std::to_string(inverted_element) + " is turned inside out" + after;
  }
  return {};
}

/// Two loops over the pairs around a solve with the kept factors.
NodeVectors Newton::improved_solution(const NonlinearSystem& system, const NodeVectors& rhs) const {
  NodeVectors q = rhs;
  std::vector<double> weight(pairs_.size());
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    weight[k] = dot(pairs_[k].step, q) / pairs_[k].product;
    q -= weight[k] * pairs_[k].change;
  }
  NodeVectors d = system.solve(q);
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    d += (weight[k] - dot(pairs_[k].change, d) / pairs_[k].product) * pairs_[k].step;
  return d;
}

/// Only pairs that keep the improved matrix positive definite.
void Newton::remember(const NonlinearSystem& system, NodeVectors step, NodeVectors change) {
  const double product = dot(step, change);
  if (system.n_negative_pivots() > 0 || !(product > 1e-8 * step.norm() * change.norm())) return;
  if (pairs_.size() == n_pairs_most) pairs_.erase(pairs_.begin());
  pairs_.push_back({std::move(step), std::move(change), product});
}

NewtonReport Newton::solve(NonlinearSystem& system, NodeVectors& u, const NodeVectors& increment, Factors factors) {
  NewtonReport report;
  pairs_.clear();
  NodeVectors here = u, last_step = increment, whole = increment;
  NonlinearSystem::Residual r;
  const auto fail = [&](NewtonOutcome outcome, Index element = -1) {
    report.outcome = outcome;
    report.inverted_element = element;
    return report;
  };
  system.evaluate(here, r);
  if (r.inverted_element >= 0) return fail(NewtonOutcome::inverted_element, r.inverted_element);

  double size_before = factors == Factors::of_the_increment ? increment.norm() : 0;  // |d| of the last iteration
  int n_growing = 0;
  for (;;) {
    const double allowed = control_.tolerance * r.scale, size_of_r = r.value.norm();
    report.residual = size_of_r / std::max(r.scale, std::numeric_limits<double>::min());
    if (size_of_r <= allowed) break;
    if (!std::isfinite(size_of_r)) return fail(NewtonOutcome::not_finite);
    if (report.n_iterations == control_.n_iterations_most) return fail(NewtonOutcome::too_many_iterations);

    NodeVectors d;
    bool is_kept = system.has_factors();
    if (is_kept) {
      d = improved_solution(system, r.value);
      if (size_before > 0) {
        const double contraction = d.norm() / size_before;
        is_kept = contraction < worst_contraction && n_iterations_left(size_of_r, allowed, contraction) <=
                                                         system.factorisation_cost() + n_iterations_of_new_factors;
      }
    }
    if (!is_kept) {
      if (const Index inverted = system.factorise(here, last_step); inverted >= 0)
        return fail(NewtonOutcome::inverted_element, inverted);
      ++report.n_factorisations;
      pairs_.clear();
      d = system.solve(r.value);
    }
    const double size = d.norm();
    if (!std::isfinite(size)) return fail(NewtonOutcome::diverged);
    n_growing = size_before > 0 && size > size_before ? n_growing + 1 : 0;
    if (n_growing > n_growing_most) return fail(NewtonOutcome::diverged);

    Step step(system, here, d);
    if (!step.halve_until_valid()) {
      const Index inverted = step.residual().inverted_element;
      return fail(inverted < 0 ? NewtonOutcome::not_finite : NewtonOutcome::inverted_element, inverted);
    }
    const bool is_new = !is_kept || (report.n_iterations == 0 && factors == Factors::of_this_start);
    if (!is_new || !system.takes_full_steps()) step.search(dot(d, r.value));
    ++report.n_iterations;
    size_before = size;
    last_step = step.length() * d;
    whole += last_step;
    remember(system, last_step, r.value - step.residual().value);
    here.swap(step.end());
    std::swap(r, step.residual());
    if (step.length() == 1 && (size <= relative_round_off * whole.norm() ||
                               d.cwiseAbs().maxCoeff() <= round_off_of_length * system.length())) {
      report.residual = r.value.norm() / std::max(r.scale, std::numeric_limits<double>::min());
      break;
    }
  }
  u.swap(here);
  return report;
}

}  // namespace couplet::solid
