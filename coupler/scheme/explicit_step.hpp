#pragma once
// One solve of each a step: for small added mass only.

#include <memory>

#include "coupler/convergence/level_guard.hpp"
#include "coupler/predictor/predictor.hpp"
#include "coupler/scheme/interface_pair.hpp"
#include "coupler/scheme/step_scheme.hpp"

namespace couplet::coupling {

/// motion at the end of the step is predicted, load = flow(predicted motion), motion = solid(load). Unstable for every
/// step size once the added mass of the fluid exceeds the mass of the solid [Causin, Gerbeau, Nobile 2005].
class ExplicitStep : public StepScheme {
 public:
  /// At time `start_time` with the state in which both were opened.
  ExplicitStep(InterfacePair& pair, std::unique_ptr<Predictor> predictor, double start_time);

  StepOutcome solve(participant::StepInterval interval) override;
  void accept(const StepOutcome& outcome, double time) override;
  void discard() override {}
  std::string diagnosis() const override;
  std::string advice() const override;
  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  InterfacePair& pair_;
  std::unique_ptr<Predictor> motion_predictor_;
  Eigen::VectorXd load_;  // accepted
  LevelGuard motion_guard_, load_guard_;
};

}  // namespace couplet::coupling
