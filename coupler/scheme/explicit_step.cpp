#include "coupler/scheme/explicit_step.hpp"

#include <utility>

namespace couplet::coupling {

ExplicitStep::ExplicitStep(InterfacePair& pair, std::unique_ptr<Predictor> predictor, double start_time)
    : pair_(pair),
      motion_predictor_(std::move(predictor)),
      load_(pair.start().load),
      motion_guard_(pair.layout().motion),
      load_guard_(pair.layout().load) {
  motion_predictor_->accept(start_time, pair.start().motion);
}

StepOutcome ExplicitStep::solve(participant::StepInterval interval) {
  StepOutcome outcome;
  interval.iteration = outcome.iterations = 1;
  motion_guard_.start_step();
  load_guard_.start_step();

  const Eigen::VectorXd predicted = motion_predictor_->predict(interval.start + interval.duration);
  outcome.state.load = pair_.solve_flow(interval, predicted);
  if (const auto trouble = load_guard_.check(outcome.state.load, load_)) {
    outcome.trouble = *trouble;
    return outcome;
  }
  outcome.state.motion = pair_.solve_solid(interval, outcome.state.load);
  if (const auto trouble = motion_guard_.check(outcome.state.motion, motion_predictor_->last())) {
    outcome.trouble = *trouble;
    return outcome;
  }
  for (const Segment& segment : pair_.layout().motion) {
    outcome.changes.push_back(measure_change(predicted.segment(segment.offset, segment.size),
                                             outcome.state.motion.segment(segment.offset, segment.size),
                                             segment.n_components));
  }
  outcome.is_solved = true;
  return outcome;
}

void ExplicitStep::accept(const StepOutcome& outcome, double time) {
  motion_guard_.accept(outcome.state.motion, motion_predictor_->last());
  load_guard_.accept(outcome.state.load, load_);
  motion_predictor_->accept(time, outcome.state.motion);
  load_ = outcome.state.load;
}

std::string ExplicitStep::diagnosis() const {
  return "explicit coupling became unstable";
}

std::string ExplicitStep::advice() const {
  return "explicit coupling is unstable for any step once the fluid's added mass reaches the solid's mass; "
         "use coupling.scheme: SERIAL_IMPLICIT";
}

void ExplicitStep::save(SavedState& state) const {
  motion_predictor_->save(state, "motion");
  state["load"] = load_;
  state["motion.levels"] = to_array(motion_guard_.largest_changes());
  state["load.levels"] = to_array(load_guard_.largest_changes());
}

void ExplicitStep::restore(const SavedState& state) {
  motion_predictor_->restore(state, "motion");
  load_ = state.at("load");
  motion_guard_.set_largest_changes(to_numbers(state.at("motion.levels")));
  load_guard_.set_largest_changes(to_numbers(state.at("load.levels")));
}

}  // namespace couplet::coupling
