#pragma once
// What a force on each volume of fluid does to the velocity.

#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

class BodyForce {
 public:
  /// `force` [N/m^3] per `density` [kg/m^3]; force and block must outlive this.
  BodyForce(const FlowBlock& block, const VectorValue& force, double density)
      : block_(block), force_(force), density_(density) {}

  /// The part that is the same everywhere, times `weight` [s]: a change of velocity [m/s].
  std::array<double, 3> uniform_change(double time, double weight) const;

  /// velocity += weight f / rho on faces of unknown velocity, for what varies in space, or for all of it.
  void add_varying(double time, double weight, VectorField& velocity) const { add(time, weight, false, velocity); }
  void add_all(double time, double weight, VectorField& velocity) const { add(time, weight, true, velocity); }

 private:
  void add(double time, double weight, bool with_uniform, VectorField& velocity) const;

  const FlowBlock& block_;
  const VectorValue& force_;
  double density_;
};

}  // namespace couplet::flow
