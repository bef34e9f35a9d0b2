#pragma once
// Convection and diffusion solved for, line by line.

#include <memory>

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/momentum/flow_block.hpp"
#include "flow-server/momentum/line_solver.hpp"

namespace couplet::flow {

/// (1 + dt/2 L_x) (1 + dt/2 L_y) (1 + dt/2 L_z) change = right side, where L_d is the discrete convection by a given
/// velocity less diffusion along direction d: the same fluxes as those of explicit_momentum.hpp. The factors differ
/// from 1 + dt/2 L by dt^2/4 L_x L_y, times a change that is itself of the order of dt [R. M. Beam, R. F. Warming, AIAA
/// J. 16 (1978) 393-402].
class ImplicitMomentum {
 public:
  /// Both must outlive this. Collective.
  ImplicitMomentum(const FlowBlock& block, const FlowBorder& border);

  /// Collective. `change`: the right side on entry, the change of velocity over the step on return. Its entries on
  /// faces whose velocity is known are that velocity's change, before and after. `carrier`: the convecting velocity
  /// with its inner ghost layer. The border must hold the values of the end of the step and remember those of its
  /// beginning.
  void solve(double half_step, double viscosity, const VectorField& carrier, VectorField& change);

  Traffic traffic() const;
  std::size_t n_bytes() const;

 private:
  void fill_rows(int component, int direction, double half_step, double viscosity, const VectorField& carrier);
  void add_inner_walls(int component, int direction, double half_step, double viscosity);
  void hold_openings(int component);
  void close_rows(int component, int direction, const VectorField& carrier, Field<double>& change);

  const FlowBlock& block_;
  const FlowBorder& border_;
  std::array<std::unique_ptr<LineSolver>, 3> lines_;
  Field<double> lower_, diagonal_, upper_;
};

}  // namespace couplet::flow
