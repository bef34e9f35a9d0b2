#include "coupler/scheme/fixed_point.hpp"

namespace couplet::coupling {

using Eigen::VectorXd;

InterfaceState SerialFixedPoint::evaluate(const participant::StepInterval& interval, const InterfaceState& before) {
  InterfaceState after;
  after.load = pair_.solve_flow(interval, before.motion);
  const bool is_relaxed = load_relaxation_ != 1;
  const VectorXd relaxed =
      is_relaxed ? VectorXd(before.load + load_relaxation_ * (after.load - before.load)) : VectorXd();
  after.motion = pair_.solve_solid(interval, is_relaxed ? relaxed : after.load);
  return after;
}

InterfaceState SerialFixedPoint::accelerate(const InterfaceState& before, const InterfaceState& after) {
  return {acceleration_->next_input(before.motion, after.motion),
          before.load + load_relaxation_ * (after.load - before.load)};
}

void SerialFixedPoint::accept(const InterfaceState& before, const InterfaceState& after) {
  acceleration_->accept_step(before.motion, after.motion);
}

InterfaceState ParallelFixedPoint::evaluate(const participant::StepInterval& interval, const InterfaceState& before) {
  return pair_.solve_both(interval, before);
}

InterfaceState ParallelFixedPoint::accelerate(const InterfaceState& before, const InterfaceState& after) {
  choose_unit(before, after);
  return unstack(acceleration_->next_input(stack(before), stack(after)));
}

void ParallelFixedPoint::accept(const InterfaceState& before, const InterfaceState& after) {
  acceleration_->accept_step(stack(before), stack(after));
}

void ParallelFixedPoint::choose_unit(const InterfaceState& before, const InterfaceState& after) {
  if (load_unit_ > 0) return;
  const Eigen::Index n_primary = pair_.layout().n_primary_motion;
  const double motion = (after.motion - before.motion).head(n_primary).norm();
  const double load = (after.load - before.load).norm();
  if (!(motion > 0 && load > 0)) return;
  load_unit_ = load / motion;
  acceleration_->discard_step();  // differences taken before are in another unit
}

void ParallelFixedPoint::save(SavedState& state) const {
  FixedPoint::save(state);
  state["load_unit"] = to_array({load_unit_});
}

void ParallelFixedPoint::restore(const SavedState& state) {
  FixedPoint::restore(state);
  load_unit_ = state.at("load_unit")(0);
}

// Primary motion, load, secondary motion.
VectorXd ParallelFixedPoint::stack(const InterfaceState& state) const {
  const InterfaceLayout& layout = pair_.layout();
  VectorXd stacked(layout.n_motion() + layout.n_load());
  stacked << state.motion.head(layout.n_primary_motion), state.load / (load_unit_ > 0 ? load_unit_ : 1),
      state.motion.tail(layout.n_secondary_motion());
  return stacked;
}

InterfaceState ParallelFixedPoint::unstack(const VectorXd& stacked) const {
  const InterfaceLayout& layout = pair_.layout();
  InterfaceState state;
  state.motion.resize(layout.n_motion());
  state.motion << stacked.head(layout.n_primary_motion), stacked.tail(layout.n_secondary_motion());
  state.load = stacked.segment(layout.n_primary_motion, layout.n_load()) * (load_unit_ > 0 ? load_unit_ : 1);
  return state;
}

}  // namespace couplet::coupling
