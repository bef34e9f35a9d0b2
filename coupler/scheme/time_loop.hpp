#pragma once
// From one accepted step to the next: solve, and when that fails throw the step away and try half of it.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coupler/scheme/step_scheme.hpp"
#include "coupler/scheme/step_size.hpp"
#include "proto/participant/participant.hpp"

namespace couplet::coupling {

struct AcceptedStep {
  std::int64_t step = 0;  // 1, 2, 3, ...
  double time = 0;        // at its end [s]
  double duration = 0;    // [s]
  int iterations = 0;     // of the attempt that was accepted
  std::vector<FieldChange> changes;
  InterfaceState state;
  std::vector<participant::NamedNumber> flow_quantities, solid_quantities;
};

class TimeLoop {
 public:
  /// `say` hears about every step that is thrown away.
  TimeLoop(participant::Participant& flow, participant::Participant& solid, std::unique_ptr<StepScheme> scheme,
           StepSize step_size, int iterations_max, std::function<void(const std::string&)> say);

  bool is_at_end() const { return step_size_.is_at_end(); }
  double time() const { return step_size_.time(); }
  std::int64_t step() const { return step_; }  // accepted so far

  /// Throws NumericsError with a diagnosis when even the smallest step fails; a participant's failures pass through.
  AcceptedStep advance();

  void save(SavedState& state) const;
  void restore(const SavedState& state);

 private:
  StepOutcome attempt();
  AcceptedStep accept(StepOutcome outcome);
  void retry_with_half(const StepOutcome& outcome);
  std::string where() const;

  participant::Participant& flow_;
  participant::Participant& solid_;
  std::unique_ptr<StepScheme> scheme_;
  StepSize step_size_;
  int easy_iterations_;  // a step with at most so many was easy
  std::function<void(const std::string&)> say_;
  std::int64_t step_ = 0;
};

}  // namespace couplet::coupling
