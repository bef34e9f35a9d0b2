#include "coupler/scheme/time_loop.hpp"

#include <cstdio>
#include <utility>

#include "proto/report/failure.hpp"

namespace couplet::coupling {

namespace {

std::string place_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace

TimeLoop::TimeLoop(participant::Participant& flow, participant::Participant& solid, std::unique_ptr<StepScheme> scheme,
                   StepSize step_size, int iterations_max, std::function<void(const std::string&)> say)
    : flow_(flow),
      solid_(solid),
      scheme_(std::move(scheme)),
      step_size_(step_size),
      easy_iterations_((iterations_max + 1) / 2),
      say_(std::move(say)) {}

AcceptedStep TimeLoop::advance() {
  for (;;) {
    StepOutcome outcome = attempt();
    if (outcome.is_solved) return accept(std::move(outcome));
    retry_with_half(outcome);
  }
}

// A solver that cannot follow a wild iterate says so by a NumericsError; its accepted state is untouched.
StepOutcome TimeLoop::attempt() {
  try {
    return scheme_->solve({step_ + 1, 1, step_size_.time(), step_size_.duration()});
  } catch (const report::NumericsError& failure) {
    StepOutcome outcome;
    outcome.trouble = failure.what();
    return outcome;
  }
}

AcceptedStep TimeLoop::accept(StepOutcome outcome) {
  AcceptedStep accepted;
  accepted.step = ++step_;
  accepted.duration = step_size_.duration();
  accepted.time = step_size_.next_time();
  accepted.iterations = outcome.iterations;
  flow_.start_accept(step_);
  solid_.start_accept(step_);
  accepted.flow_quantities = flow_.finish_accept();
  accepted.solid_quantities = solid_.finish_accept();
  scheme_->accept(outcome, accepted.time);
  step_size_.accept(outcome.iterations <= easy_iterations_);
  accepted.changes = std::move(outcome.changes);
  accepted.state = std::move(outcome.state);
  return accepted;
}

void TimeLoop::retry_with_half(const StepOutcome& outcome) {
  const std::string place = where();
  const std::string diagnosis = scheme_->diagnosis(), advice = scheme_->advice();
  scheme_->discard();
  const std::string sentence = outcome.trouble + (diagnosis.empty() ? "" : "; " + diagnosis);
  if (!step_size_.halve()) {
    throw report::NumericsError(
        place, "the step does not converge even when it is halved as often as allowed: " + sentence, advice);
  }
  say_(place + ": " + sentence + "; tried again with half the step");
}

std::string TimeLoop::where() const {
  return "step " + std::to_string(step_ + 1) + " from t = " + place_number(step_size_.time()) +
         " s by dt = " + place_number(step_size_.duration()) + " s";
}

void TimeLoop::save(SavedState& state) const {
  state["step"] = to_array({static_cast<double>(step_)});
  step_size_.save(state);
  scheme_->save(state);
}

void TimeLoop::restore(const SavedState& state) {
  step_ = static_cast<std::int64_t>(state.at("step")(0));
  step_size_.restore(state);
  scheme_->restore(state);
}

}  // namespace couplet::coupling
