#include "solid-server/dynamics/arc_length.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/sparse_cholesky.hpp"

namespace couplet::solid {

namespace {

double inner_product(const NodeVectors& a, const NodeVectors& b) {
  return a.cwiseProduct(b).sum();
}

/// A path on its way from one converged point to the next.
class Path {
 public:
  Path(LoadedSystem& system, const ArcLengthControl& control, NodeVectors& u, double& load, PathReport& report)
      : system_(system), control_(control), u_(u), load_(load), report_(report) {}

  bool find_tangent();
  bool advance_arc();
  bool end_at(double wanted_load);
  void forget_last_arc();

  double load_before() const { return load_before_; }
  int n_negative_pivots() const { return n_negative_pivots_; }
  void note_limit();

 private:
  bool correct(NodeVectors& end, double& load);
  std::optional<double> load_change(const NodeVectors& arc, const NodeVectors& d_r, const NodeVectors& d_q) const;
  bool factorise(const NodeVectors& at, const NodeVectors& increment);

  LoadedSystem& system_;
  const ArcLengthControl& control_;
  NodeVectors& u_;
  double& load_;
  PathReport& report_;
  NodeVectors tangent_;     // du/d(load) at the point
  NodeVectors arc_before_;  // the last arc; empty before the first
  double length_ = 0, length_first_ = 0;
  double load_before_ = 0;
  int n_negative_pivots_ = 0;
  int n_iterations_of_arc_ = 0;
  double arc_of_[2] = {0, 0}, change_of_[2] = {0, 0};  // lengths and load changes of the last two arcs
  int n_known_ = 0;
};

bool Path::factorise(const NodeVectors& at, const NodeVectors& increment) {
  ++report_.n_factorisations;
  try {
    return system_.factorise(at, increment) < 0;
  } catch (const SingularMatrix&) {
    return false;
  }
}

/// The tangent of the path at the point, and the stability of the point.
bool Path::find_tangent() {
  if (!factorise(u_, NodeVectors::Zero(u_.rows(), 4))) return false;
  n_negative_pivots_ = system_.n_negative_pivots();
  tangent_ = system_.solve(system_.load_rate(u_));
  if (length_ == 0)
    length_ = length_first_ = std::min(control_.first_load_step * tangent_.norm(), control_.longest_first_arc);
  return std::isfinite(length_) && length_ > 0;
}

/// The next point. False when even the shortest arc fails.
bool Path::advance_arc() {
  for (; length_ >= std::ldexp(length_first_, -control_.n_halvings_most); length_ /= 2) {
    double step = length_ / tangent_.norm();
    if (arc_before_.size() > 0 && inner_product(arc_before_, tangent_) < 0) step = -step;
    NodeVectors end = u_ + step * tangent_;
    double load = load_ + step;
    if (!correct(end, load)) continue;
    const NodeVectors arc = end - u_;
    if (inner_product(arc, tangent_) * step < 0.5 * arc.norm() * tangent_.norm() * std::abs(step)) continue;
    load_before_ = load_;
    arc_before_ = arc;
    arc_of_[0] = arc_of_[1], change_of_[0] = change_of_[1];
    arc_of_[1] = length_, change_of_[1] = load - load_;
    ++n_known_;
    u_.swap(end);
    load_ = load;
    ++report_.n_arcs;
    const double factor =
        std::sqrt(static_cast<double>(control_.n_iterations_wanted) / std::max(n_iterations_of_arc_, 1));
    length_ = std::min(length_ * std::clamp(factor, 0.5, 2.0), control_.longest_arc * length_first_);
    return true;
  }
  return false;
}

/// Corrections at constant arc length.
bool Path::correct(NodeVectors& end, double& load) {
  NonlinearSystem::Residual r;
  NodeVectors last = end - u_;
  system_.set_load(load, end);
  system_.evaluate(end, r);
  double smallest = std::numeric_limits<double>::max();
  int n_growing = 0;
  for (n_iterations_of_arc_ = 0;; ++n_iterations_of_arc_) {
    if (r.inverted_element >= 0 || !r.value.allFinite()) return false;
    if (r.value.norm() <= control_.tolerance * r.scale) return true;
    if (n_iterations_of_arc_ == control_.n_iterations_most) return false;
    if (!factorise(end, last)) return false;
    const NodeVectors d_r = system_.solve(r.value), d_q = system_.solve(system_.load_rate(end));
    const auto change = load_change(end - u_, d_r, d_q);
    if (!change) return false;
    ++report_.n_iterations;
    last = d_r + *change * d_q;
    if (!(last.norm() < 2 * length_)) return false;  // to the other side of the circle
    end += last;
    load += *change;
    system_.set_load(load, end);
    system_.evaluate(end, r);
    const double size = last.norm();
    if (size <= 1e-9 * length_ || last.cwiseAbs().maxCoeff() <= 1e-13 * system_.length())
      return r.inverted_element < 0 && r.value.allFinite();
    if (size < smallest)
      smallest = size;
    else if (++n_growing > 4)
      return false;
  }
}

/// The root of |arc + d_r + x d_q|^2 = l^2 whose new arc turns least from the old one. None: the circle is not met.
std::optional<double> Path::load_change(const NodeVectors& arc, const NodeVectors& d_r, const NodeVectors& d_q) const {
  const NodeVectors base = arc + d_r;
  const double a = inner_product(d_q, d_q), b = inner_product(base, d_q),
               c = inner_product(base, base) - length_ * length_;
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0) || !(a > 0)) return std::nullopt;
  const double root = std::sqrt(discriminant), along = inner_product(arc, d_q);
  return (-b + (along >= 0 ? root : -root)) / a;  // arc . (base + x d_q) is the greater, the greater x along is
}

/// From the last point, which lies beyond the wanted load, back onto it along the arc, with the load held.
bool Path::end_at(double wanted_load) {
  const double share = (wanted_load - load_before_) / (load_ - load_before_);
  const NodeVectors start = u_ - arc_before_;
  NodeVectors end = start + share * arc_before_;
  system_.set_load(wanted_load, end);
  Newton newton({control_.tolerance});
  const NewtonReport report = newton.solve(system_, end, share * arc_before_);
  report_.n_iterations += report.n_iterations;
  report_.n_factorisations += report.n_factorisations;
  // With the load held, Newton's method may find another branch: it must not be further than the arc was long.
  if (!report.has_converged() || (end - start).norm() > 1.5 * arc_before_.norm()) return false;
  u_.swap(end);
  load_ = wanted_load;
  return true;
}

void Path::forget_last_arc() {
  u_ -= arc_before_;
  load_ = load_before_;
  length_ = std::min(length_, arc_before_.norm()) / 4;
  arc_of_[1] = arc_of_[0], change_of_[1] = change_of_[0];
  n_known_ = std::min(n_known_ - 1, 1);
}

/// Extremum of the parabola through the last three points, over the length of the arcs.
void Path::note_limit() {
  if (n_known_ < 2 || change_of_[0] * change_of_[1] >= 0) return;
  const double slope_0 = change_of_[0] / arc_of_[0], slope_1 = change_of_[1] / arc_of_[1];
  const double curvature = (slope_1 - slope_0) / ((arc_of_[0] + arc_of_[1]) / 2);
  const double slope =
      (slope_0 * arc_of_[1] + slope_1 * arc_of_[0]) / (arc_of_[0] + arc_of_[1]);  // at the middle point
  report_.limit_loads.push_back(load_before_ - slope * slope / (2 * curvature));
}

}  // namespace

PathReport follow_path(LoadedSystem& system, const ArcLengthControl& control, NodeVectors& u, double& load,
                       double wanted_load, const std::function<bool(const PathPoint&)>& visit) {
  PathReport report;
  Path path(system, control, u, load, report);
  const auto fail = [&](std::string why) {
    report.failure = std::move(why);
    return report;
  };
  for (;;) {
    if (!path.find_tangent()) return fail("the tangent at load factor " + report::text(load) + " has no solution");
    report.n_negative_pivots = path.n_negative_pivots();
    if (report.n_arcs > 0 && !visit({load, &u, path.n_negative_pivots()})) return report;
    for (;;) {
      if (report.n_arcs == control.n_arcs_most)
        return fail("the load factor is " + report::text(load) + " after " + std::to_string(report.n_arcs) + " arcs");
      if (!path.advance_arc())
        return fail("no equilibrium is found on the shortest arc from load factor " + report::text(load));
      if ((load - wanted_load) * (path.load_before() - wanted_load) > 0) break;
      if (path.end_at(wanted_load)) {
        report.has_reached_load = true;
        if (path.find_tangent()) report.n_negative_pivots = path.n_negative_pivots();
        visit({load, &u, report.n_negative_pivots});
        return report;
      }
      path.forget_last_arc();  // a shorter arc leads closer
    }
    path.note_limit();
  }
}

}  // namespace couplet::solid
