#pragma once
// The velocity at the end of a step but for its divergence, by each of the time schemes.

#include <memory>

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/immersed/immersed_bodies.hpp"
#include "flow-server/momentum/body_force.hpp"
#include "flow-server/momentum/implicit_momentum.hpp"
#include "flow-server/navier_stokes/flow_ghosts.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"

namespace couplet::flow {

class Predictor {
 public:
  /// All must outlive this.
  /// `bodies`: null where there are none.
  Predictor(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border, FlowGhosts& ghosts,
            ImmersedBodies* bodies);

  /// Collective. u* = u + dt [convection and diffusion by the scheme - grad p / rho + f], with the pressure p of the
  /// step before; leaves in the end state what the scheme will want to know of this step. `scheme` is not automatic.
  void predict(const FlowState& from, double dt, TimeScheme scheme, FlowState& to);

  /// What Crank-Nicolson remembers of a step that has ended: the mean acceleration, ghosts included.
  void remember_acceleration(const FlowState& from, double dt, FlowState& to) const;

  std::size_t n_bytes() const;
  Traffic traffic() const;

 private:
  void predict_by_adams_bashforth(const FlowState& from, double dt, FlowState& to);
  void predict_by_runge_kutta(const FlowState& from, double dt, bool keeps_rate, FlowState& to);
  void predict_by_crank_nicolson(const FlowState& from, double dt, FlowState& to);
  void damp_openings(double dt, const FlowState& from, const VectorField* acceleration, VectorField& velocity) const;
  void combine(const VectorField& a, double factor, const VectorField& b, VectorField& sum) const;

  const NavierStokesSetup& setup_;
  const FlowBlock& block_;
  FlowBorder& border_;
  FlowGhosts& ghosts_;
  ImmersedBodies* bodies_;
  BodyForce force_;
  std::unique_ptr<ImplicitMomentum> implicit_;  // Crank-Nicolson only
  VectorField stage_;                           // of Runge-Kutta; the convecting velocity of Crank-Nicolson
  VectorField rate_;                            // of Runge-Kutta
};

}  // namespace couplet::flow
