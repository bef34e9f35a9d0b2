#pragma once
// Iterates flow and solid until both agree.

#include <memory>

#include "coupler/convergence/convergence_history.hpp"
#include "coupler/convergence/level_guard.hpp"
#include "coupler/predictor/predictor.hpp"
#include "coupler/scheme/fixed_point.hpp"
#include "coupler/scheme/step_scheme.hpp"

namespace couplet::coupling {

class ImplicitStep : public StepScheme {
 public:
  /// At time `start_time` with the state in which both participants were opened.
  ImplicitStep(const InterfacePair& pair, std::unique_ptr<FixedPoint> fixed_point, ConvergenceHistory& history,
               std::unique_ptr<Predictor> motion_predictor, std::unique_ptr<Predictor> load_predictor,
               int iterations_max, double start_time);

  StepOutcome solve(participant::StepInterval interval) override;
  void accept(const StepOutcome& outcome, double time) override;
  void discard() override;
  std::string diagnosis() const override;
  std::string advice() const override;
  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  void start_attempt();
  std::optional<std::string> find_trouble(const InterfaceState& after);
  std::vector<FieldChange> measure_changes(const InterfaceState& before, const InterfaceState& after) const;
  bool has_converged(const std::vector<FieldChange>& changes) const;

  const InterfaceLayout& layout_;
  std::unique_ptr<FixedPoint> fixed_point_;
  ConvergenceHistory& history_;
  std::unique_ptr<Predictor> motion_predictor_, load_predictor_;
  int iterations_max_;
  LevelGuard motion_guard_, load_guard_;
  InterfaceState last_input_;  // of the last iteration
};

}  // namespace couplet::coupling
