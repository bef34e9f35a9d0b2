#pragma once
// Static equilibrium: time is the parameter of the loads.

#include "solid-server/dynamics/arc_length.hpp"
#include "solid-server/dynamics/time_integrator.hpp"

namespace couplet::solid {

struct StaticControl {
  NewtonControl newton;
  bool may_follow_path = true;  // by arc length, where steps of the load fail
  ArcLengthControl path;        // its first load step is taken from the step that failed
};

/// A step of the load is a step of time: pressures, prescribed motions and other tables are taken at its end, the
/// interface force likewise (a body at rest begins without one). The prediction follows the tangent at the start; kept
/// factors serve all iterations that they are good enough for. A load step whose iteration fails, or ends on another
/// branch (an equilibrium that is less stable than the one before, or much further away than the tangent says), or in
/// which surfaces come deeper into contact than they can be followed, is halved, at most four times, and grows again
/// after two successes. When that is not enough the load has a limit there, or the path turns: it is followed by arc
/// length through the limit points to the next equilibrium at the wanted load (a snap-through in dynamics), as long as
/// the control allows it. Outside the step the loads of the path are straight lines through its start and end.
///
/// Velocity and acceleration are zero. After each step the tangent at the equilibrium tells its stability
/// (StepWork::n_negative_pivots).
class StaticSolution : public TimeIntegrator, private LoadedSystem {
 public:
  StaticSolution(std::unique_ptr<BodyEquations> body, StaticControl control)
      : body_(std::move(body)), control_(control) {}

  StepWork advance(const Motion& from, double duration, const surface::NodeArray& interface_force, Motion& to) override;

  /// From a motion along its path of equilibrium: the load factor is 0 at `from` and 1 under the loads after `duration`
  /// and the interface force. Ends at factor 1 or when `visit` returns false; `to` is the last point.
  PathReport follow(const Motion& from, double duration, const surface::NodeArray& interface_force,
                    const ArcLengthControl& control, const std::function<bool(const PathPoint&)>& visit, Motion& to);

  NodeVectors mass_times(const NodeVectors& vector) const override { return body_->mass_times(vector); }
  std::vector<double> support_force(const Motion& motion,
                                    const std::vector<HeldMotion::Component>& held) const override;
  std::size_t memory_bytes() const override { return body_->memory_bytes(); }
  const TangentCost& cost() const { return body_->cost(); }

 private:
  // The equilibrium at one load factor, which is the fraction of the step.
  void evaluate(const NodeVectors& u, Residual& residual) override;
  Index factorise(const NodeVectors& u, const NodeVectors& increment) override;
  bool has_factors() const override { return body_->origin() != nullptr; }
  NodeVectors solve(const NodeVectors& rhs) const override { return body_->solve_unsymmetric(rhs); }
  int n_negative_pivots() const override { return body_->n_negative_pivots(); }
  bool takes_full_steps() const override { return !body_->is_touching(); }
  double factorisation_cost() const override { return body_->factorisation_cost(); }
  double length() const override { return body_->length(); }
  void set_load(double factor, NodeVectors& u) override;
  NodeVectors load_rate(const NodeVectors& u) override;

  // Inside the step loads and prescribed motions are those of the time; a path that leaves it, for loads that are below
  // those of its start (an arch that snaps through has to be held back) or above those of its end, finds them
  // continued as straight lines through start and end.
  static bool is_in_step(double factor) { return factor >= 0 && factor <= 1; }
  void hold(double factor, NodeVectors& u);
  Index forces(const NodeVectors& u, double factor, NodeVectors& force);

  void begin(const Motion& from, double duration, const surface::NodeArray& interface_force, Motion& to);
  bool load_step(double factor_start, double factor_end, NodeVectors& u, StepWork& work, std::string& why_not);
  void finish(double factor, Motion& to);
  Moment moment(double factor) const { return {start_time_ + factor * duration_, factor, false}; }

  std::unique_ptr<BodyEquations> body_;
  StaticControl control_;
  double start_time_ = 0, duration_ = 0;  // [s]
  double factor_ = 0;                     // of the load
  double external_size_ = 0;              // |external forces| at the factor [N]
  surface::NodeArray interface_force_;
  std::shared_ptr<const FactorOrigin> at_equilibrium_;  // the last one found; null: none yet
};

}  // namespace couplet::solid
