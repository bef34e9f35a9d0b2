#pragma once
// One coupling iteration as a map of interface states, and the acceleration that belongs to it.

#include <memory>

#include "coupler/acceleration/acceleration.hpp"
#include "coupler/scheme/interface_pair.hpp"

namespace couplet::coupling {

class FixedPoint {
 public:
  explicit FixedPoint(std::unique_ptr<Acceleration> acceleration) : acceleration_(std::move(acceleration)) {}
  virtual ~FixedPoint() = default;

  /// What flow and solid answer to `before`.
  virtual InterfaceState evaluate(const participant::StepInterval& interval, const InterfaceState& before) = 0;

  /// The state to try next.
  virtual InterfaceState accelerate(const InterfaceState& before, const InterfaceState& after) = 0;

  virtual void accept(const InterfaceState& before, const InterfaceState& after) = 0;

  virtual void save(SavedState& state) const { acceleration_->save(state); }
  virtual void restore(const SavedState& state) { acceleration_->restore(state); }

  Acceleration& acceleration() { return *acceleration_; }
  const Acceleration& acceleration() const { return *acceleration_; }

 protected:
  std::unique_ptr<Acceleration> acceleration_;
};

/// Gauss-Seidel: load = flow(motion), then motion = solid(load). Only the motion is accelerated; the load may be
/// relaxed before the solid sees it.
class SerialFixedPoint : public FixedPoint {
 public:
  SerialFixedPoint(InterfacePair& pair, std::unique_ptr<Acceleration> acceleration, double load_relaxation)
      : FixedPoint(std::move(acceleration)), pair_(pair), load_relaxation_(load_relaxation) {}

  InterfaceState evaluate(const participant::StepInterval& interval, const InterfaceState& before) override;
  InterfaceState accelerate(const InterfaceState& before, const InterfaceState& after) override;
  void accept(const InterfaceState& before, const InterfaceState& after) override;

 private:
  InterfacePair& pair_;
  double load_relaxation_;  // [1]
};

/// Jacobi: flow(motion) and solid(load) at the same time. Motion and load are accelerated together, each in the unit
/// that makes its first residual 1, so that neither hides the other.
class ParallelFixedPoint : public FixedPoint {
 public:
  ParallelFixedPoint(InterfacePair& pair, std::unique_ptr<Acceleration> acceleration)
      : FixedPoint(std::move(acceleration)), pair_(pair) {}

  InterfaceState evaluate(const participant::StepInterval& interval, const InterfaceState& before) override;
  InterfaceState accelerate(const InterfaceState& before, const InterfaceState& after) override;
  void accept(const InterfaceState& before, const InterfaceState& after) override;

  void save(SavedState& state) const override;
  void restore(const SavedState& state) override;

 private:
  void choose_unit(const InterfaceState& before, const InterfaceState& after);
  Eigen::VectorXd stack(const InterfaceState& state) const;
  InterfaceState unstack(const Eigen::VectorXd& stacked) const;

  InterfacePair& pair_;
  double load_unit_ = 0;  // load of this size counts like a motion of size 1; 0: not chosen yet
};

}  // namespace couplet::coupling
