#pragma once
// One time step of the incompressible flow.

#include <memory>
#include <string>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/flow_state.hpp"
#include "flow-server/immersed/body_loads.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"

namespace couplet::flow {

/// What a call of advance() did; the same on all ranks.
struct AdvanceReport {
  int n_steps = 0;
  double smallest_step = 0;      // [s]
  double courant = 0;            // largest sum of |u| dt / dx that was met
  double largest_speed = 0;      // [m/s]
  double divergence = 0;         // after the last projection: largest |div u| [1/s]
  double divergence_rms = 0;     // root of its volume-weighted mean square [1/s]
  int pressure_iterations = 0;   // in all steps together
  double pressure_residual = 0;  // of the last solve, over the norm of its source
  double net_inflow = 0;         // through prescribed borders before it was balanced [m^3/s]
  std::string scheme;            // that was used: adams_bashforth, runge_kutta, crank_nicolson
};

class FractionalStep {
 public:
  /// Throws SceneError where the setup cannot be solved. The decomposition must outlive this.
  FractionalStep(NavierStokesSetup setup, const BlockDecomposition& decomposition);
  ~FractionalStep();

  const NavierStokesSetup& setup() const;
  const BlockDecomposition& decomposition() const;
  const ActiveCells& active() const;  // of the cells of this rank

  /// The state at t = 0: the initial velocity made free of divergence, ghosts filled.
  FlowState initial_state();

  /// Bodies of a state at its time, with no pressure of their own yet; nothing where there are none: after a restart.
  void place_bodies(FlowState& state);

  /// Collective. Fills ghosts and speeds of a state whose times, velocity, pressure and rate were set: after a restart.
  /// Faces at the start of the block (entry -1) on openings and outflows of the border are part of what must be set.
  void fill_ghosts(FlowState& state);

  /// Solves over `duration` [s] in as many equal steps as stability asks for. `start` stays as it is; `end` may be any
  /// state of the same shape, or empty. Equal arguments give equal bits. Throws NumericsError.
  AdvanceReport advance(const FlowState& start, double duration, FlowState& end);

  /// Collective. The force of the fluid on each surface of NavierStokesSetup::bodies; the same on all ranks.
  std::vector<SurfaceLoad> body_loads(const FlowState& state) const;

  std::size_t n_bytes() const;  // held on this rank, without the states
  Traffic traffic() const;      // sent so far by this rank

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace couplet::flow
