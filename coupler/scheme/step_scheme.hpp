#pragma once
// The door of all schemes: how one time step is solved.

#include <string>
#include <vector>

#include "coupler/checkpoint/saved_state.hpp"
#include "coupler/convergence/criterion.hpp"
#include "coupler/scheme/interface_layout.hpp"
#include "proto/participant/participant.hpp"

namespace couplet::coupling {

struct StepOutcome {
  bool is_solved = false;
  int iterations = 0;
  std::string trouble;               // why it is not solved
  InterfaceState state;              // at the end of the step
  std::vector<FieldChange> changes;  // of the last iteration, in the order of the criteria
};

/// The contract. solve works from the last accepted state and may be repeated with another interval after discard;
/// accept takes over what the last solve found. Throws what the participants throw.
class StepScheme {
 public:
  virtual ~StepScheme() = default;

  virtual StepOutcome solve(participant::StepInterval interval) = 0;
  virtual void accept(const StepOutcome& outcome, double time) = 0;
  virtual void discard() = 0;

  /// What to tell the user when no step size works.
  virtual std::string diagnosis() const = 0;
  virtual std::string advice() const = 0;

  virtual void save(SavedState& state) const = 0;
  virtual void restore(const SavedState& state) = 0;
};

}  // namespace couplet::coupling
