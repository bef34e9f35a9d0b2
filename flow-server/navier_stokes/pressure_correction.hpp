#pragma once
// The pressure that takes the divergence out of a velocity.

#include <memory>

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/immersed/immersed_bodies.hpp"
#include "flow-server/navier_stokes/flow_ghosts.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"
#include "flow-server/navier_stokes/projection.hpp"

namespace couplet::flow {

class PressureCorrection {
 public:
  /// All must outlive this. Collective.
  /// `bodies`: null where there are none.
  PressureCorrection(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border, FlowGhosts& ghosts,
                     ImmersedBodies* bodies);

  /// What a correction found and left.
  struct Result {
    SolveReport solved;
    FlowMeasure measure;
  };

  /// Collective. Ends a step: div grad phi = rho div u* / dt, u = u* - dt / rho grad phi, p += phi. The bodies of
  /// the end state stand in their places. Sets its times and measures and fills its ghosts. Throws NumericsError where
  /// divergence is left.
  Result correct_step(const FlowState& from, double dt, FlowState& to);

  /// Collective. u -= grad phi with div grad phi = div u, almost to round-off: for an initial velocity.
  void make_solenoidal(FlowState& state);

  /// Collective. The pressure with div grad p = rho div(acceleration), where `acceleration` holds that by all other
  /// terms [m/s^2].
  void find_pressure(VectorField& acceleration, Field<double>& pressure);

  /// Collective. Bodies of a state at its time; nothing where there are none.
  void place_bodies(double time, FlowState& state);

  /// Collective. What the steps from this state on are planned with.
  void measure_speed(FlowState& state);

  std::size_t n_bytes() const;
  Traffic traffic() const;

 private:
  void force_walls(const FlowState& from, double step_over_density, FlowState& to);
  void take_divergence_of(VectorField& velocity, double factor, const BodyGeometry* bodies);
  double body_that_leaves(const BodyGeometry& now) const;
  FlowMeasure correct_velocity(const FlowState& from, double step_over_density, double viscous_factor, FlowState& to);
  SolveReport solve(const SolveLimits& limits);
  const ActiveCells& measured() const { return bodies_ ? whole_cells_ : block_.cells; }

  const NavierStokesSetup& setup_;
  const FlowBlock& block_;
  FlowBorder& border_;
  FlowGhosts& ghosts_;
  PressureProblem problem_;  // outlives its solver
  std::unique_ptr<PressureSolver> solver_;
  Field<double> source_, phi_;
  ImmersedBodies* bodies_;  // null where there are none
  std::vector<double> piece_source_, piece_phi_, further_phi_;
  ActiveCells whole_cells_ = ActiveCells::all({});  // that no body cuts
  double smallest_width_;                           // [m]
  std::int64_t n_reductions_ = 0;
};

}  // namespace couplet::flow
