#include "coupler/scheme/implicit_step.hpp"

#include <algorithm>
#include <utility>

#include "coupler/scheme/diagnosis.hpp"

namespace couplet::coupling {

ImplicitStep::ImplicitStep(const InterfacePair& pair, std::unique_ptr<FixedPoint> fixed_point,
                           ConvergenceHistory& history, std::unique_ptr<Predictor> motion_predictor,
                           std::unique_ptr<Predictor> load_predictor, int iterations_max, double start_time)
    : layout_(pair.layout()),
      fixed_point_(std::move(fixed_point)),
      history_(history),
      motion_predictor_(std::move(motion_predictor)),
      load_predictor_(std::move(load_predictor)),
      iterations_max_(iterations_max),
      motion_guard_(layout_.motion),
      load_guard_(layout_.load) {
  motion_predictor_->accept(start_time, pair.start().motion);
  load_predictor_->accept(start_time, pair.start().load);
}

StepOutcome ImplicitStep::solve(participant::StepInterval interval) {
  const double end = interval.start + interval.duration;
  StepOutcome outcome;
  InterfaceState before = {motion_predictor_->predict(end), load_predictor_->predict(end)};
  start_attempt();

  for (interval.iteration = 1; interval.iteration <= iterations_max_; ++interval.iteration) {
    outcome.iterations = interval.iteration;
    outcome.state = fixed_point_->evaluate(interval, before);
    if (const auto trouble = find_trouble(outcome.state)) {
      outcome.trouble = *trouble;
      return outcome;
    }
    outcome.changes = measure_changes(before, outcome.state);
    history_.add(interval, outcome.changes);
    if (has_converged(outcome.changes)) {
      outcome.is_solved = true;
      last_input_ = std::move(before);
      return outcome;
    }
    before = fixed_point_->accelerate(before, outcome.state);
  }
  outcome.trouble = "not converged after " + std::to_string(iterations_max_) + " iterations";
  return outcome;
}

void ImplicitStep::accept(const StepOutcome& outcome, double time) {
  fixed_point_->accept(last_input_, outcome.state);
  motion_guard_.accept(outcome.state.motion, motion_predictor_->last());
  load_guard_.accept(outcome.state.load, load_predictor_->last());
  // The input is the better continuation: an error of x stands in G(x) enlarged by the added-mass number.
  motion_predictor_->accept(time, last_input_.motion);
  load_predictor_->accept(time, outcome.state.load);
}

void ImplicitStep::discard() {
  fixed_point_->acceleration().discard_step();
}

void ImplicitStep::start_attempt() {
  fixed_point_->acceleration().start_step();
  history_.start_attempt();
  motion_guard_.start_step();
  load_guard_.start_step();
}

std::optional<std::string> ImplicitStep::find_trouble(const InterfaceState& after) {
  if (auto trouble = load_guard_.check(after.load, load_predictor_->last())) return trouble;
  return motion_guard_.check(after.motion, motion_predictor_->last());
}

std::vector<FieldChange> ImplicitStep::measure_changes(const InterfaceState& before,
                                                       const InterfaceState& after) const {
  std::vector<FieldChange> changes;
  for (const Criterion& criterion : history_.criteria()) {
    const auto is_field = [&](const Segment& segment) { return segment.name == criterion.field; };
    const auto in_motion = std::find_if(layout_.motion.begin(), layout_.motion.end(), is_field);
    const bool is_motion = in_motion != layout_.motion.end();
    const Segment& segment = is_motion ? *in_motion : *std::find_if(layout_.load.begin(), layout_.load.end(), is_field);
    const Eigen::VectorXd& from = is_motion ? before.motion : before.load;
    const Eigen::VectorXd& to = is_motion ? after.motion : after.load;
    changes.push_back(measure_change(from.segment(segment.offset, segment.size),
                                     to.segment(segment.offset, segment.size), segment.n_components));
  }
  return changes;
}

bool ImplicitStep::has_converged(const std::vector<FieldChange>& changes) const {
  for (std::size_t k = 0; k < changes.size(); ++k) {
    if (!coupling::has_converged(history_.criteria()[k], changes[k])) return false;
  }
  return true;
}

std::string ImplicitStep::diagnosis() const {
  return describe_attempt(history_, fixed_point_->acceleration().added_mass_number());
}

std::string ImplicitStep::advice() const {
  return advise(history_, fixed_point_->acceleration().added_mass_number(), iterations_max_);
}

void ImplicitStep::save(SavedState& state) const {
  motion_predictor_->save(state, "motion");
  load_predictor_->save(state, "load");
  state["motion.levels"] = to_array(motion_guard_.largest_changes());
  state["load.levels"] = to_array(load_guard_.largest_changes());
  fixed_point_->save(state);
}

void ImplicitStep::restore(const SavedState& state) {
  motion_predictor_->restore(state, "motion");
  load_predictor_->restore(state, "load");
  motion_guard_.set_largest_changes(to_numbers(state.at("motion.levels")));
  load_guard_.set_largest_changes(to_numbers(state.at("load.levels")));
  fixed_point_->restore(state);
}

}  // namespace couplet::coupling
