#include "flow-server/navier_stokes/fractional_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "flow-server/navier_stokes/flow_domain.hpp"
#include "flow-server/navier_stokes/flow_failure.hpp"
#include "flow-server/navier_stokes/flow_ghosts.hpp"
#include "flow-server/navier_stokes/initial_flow.hpp"
#include "flow-server/navier_stokes/predictor.hpp"
#include "flow-server/navier_stokes/pressure_correction.hpp"
#include "flow-server/navier_stokes/step_limit.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

/// An interval that asks for more steps than a million will not end: the flow has blown up.
constexpr double shortest_share = 1e-6;

using report::text;

const NavierStokesSetup& checked(const NavierStokesSetup& setup, const BlockDecomposition& decomposition) {
  const auto refuse = [](const std::string& where, double value, const std::string& unit, const std::string& advice) {
    throw report::SceneError(where, "is " + text(value) + " " + unit, advice);
  };
  if (!(setup.density > 0) || !std::isfinite(setup.density))
    refuse("density of the fluid", setup.density, "kg/m^3", "give a positive number");
  if (!(setup.viscosity >= 0) || !std::isfinite(setup.viscosity))
    refuse("viscosity of the fluid", setup.viscosity, "Pa s", "give 0 or a positive number");
  if (!(setup.step.largest > 0)) refuse("largest step", setup.step.largest, "s", "give a positive number");
  if (setup.bodies && setup.scheme == TimeScheme::crank_nicolson)
    throw report::SceneError("time scheme", "is Crank-Nicolson in a flow with bodies, whose lines do not end at walls",
                             "take RUNGE_KUTTA or ADAMS_BASHFORTH");
  if (setup.step.courant <= 0) refuse("Courant number", setup.step.courant, "", "give a positive number");
  if (setup.grid.is_periodic() != decomposition.is_periodic() || setup.grid.n_cells() != decomposition.all().end)
    throw report::SceneError("decomposition", "does not belong to the grid of the flow");
  return setup;
}

/// The report of several steps: extremes and sums of all, the rest of the last one.
void append(AdvanceReport& all, AdvanceReport step) {
  if (all.n_steps > 0) {
    step.n_steps += all.n_steps;
    step.smallest_step = std::min(all.smallest_step, step.smallest_step);
    step.courant = std::max(all.courant, step.courant);
    step.pressure_iterations += all.pressure_iterations;
  }
  all = std::move(step);
}

}  // namespace

struct FractionalStep::Parts {
  Parts(NavierStokesSetup given, const BlockDecomposition& blocks)
      : setup(std::move(given)),
        decomposition(blocks),
        solid(find_fixed_solid(checked(setup, blocks), blocks)),
        border(setup.grid, blocks, setup.border, fluid_of(setup, solid), setup.balances_inflow),
        block(make_flow_block(setup, blocks, border, solid)),
        ghosts(block, border),
        bodies(setup.bodies ? std::make_unique<ImmersedBodies>(block, setup.body_settings) : nullptr),
        predictor(setup, block, border, ghosts, bodies.get()),
        correction(setup, block, border, ghosts, bodies.get()),
        diffusion(diffusion_rate(setup.grid, setup.kinematic_viscosity())) {
    std::int64_t n_cells = block.cells.n_cells();
    MPI_Allreduce(MPI_IN_PLACE, &n_cells, 1, MPI_INT64_T, MPI_SUM, blocks.communicator());
    if (n_cells == 0)
      throw report::SceneError("flow", "no cell holds fluid", "change the formula that says where fluid is");
  }

  void shape(FlowState& state) const;
  bool is_too_long(double dt, TimeScheme scheme, const StepRates& rates) const {
    return dt > 1.2 * longest_step(scheme, rates, setup.step);
  }
  AdvanceReport report(const FlowState& from, double dt, TimeScheme scheme, const FlowState& to,
                       const PressureCorrection::Result& corrected) const;

  NavierStokesSetup setup;
  const BlockDecomposition& decomposition;
  FixedSolid solid;
  FlowBorder border;
  FlowBlock block;
  FlowGhosts ghosts;
  std::unique_ptr<ImmersedBodies> bodies;  // where there are any
  Predictor predictor;
  PressureCorrection correction;
  double diffusion;  // largest eigenvalue [1/s]
  FlowState spare;   // of several steps in one interval
};

FractionalStep::FractionalStep(NavierStokesSetup setup, const BlockDecomposition& decomposition)
    : parts_(std::make_unique<Parts>(std::move(setup), decomposition)) {}
FractionalStep::~FractionalStep() = default;

const NavierStokesSetup& FractionalStep::setup() const {
  return parts_->setup;
}
const BlockDecomposition& FractionalStep::decomposition() const {
  return parts_->decomposition;
}
const ActiveCells& FractionalStep::active() const {
  return parts_->block.cells;
}

/// From the start state, which is never written to, through as many steps as stability asks for, into the end state.
AdvanceReport FractionalStep::advance(const FlowState& start, double duration, FlowState& end) {
  Parts& parts = *parts_;
  if (!(duration > 0) || !std::isfinite(duration))
    throw report::SceneError("time step", "is " + text(duration) + " s", "give a positive number");
  const double smallest_step = std::max(parts.setup.step.smallest, shortest_share * duration);
  AdvanceReport all;
  StepPlan plan{TimeScheme::automatic, 0};
  const FlowState* from = &start;
  for (double done = 0; done < duration;) {
    // Planned once; again where the flow has become faster than the plan allows.
    StepRates rates{from->courant_rate, parts.diffusion, !parts.bodies};
    if (plan.n_steps == 0 || parts.is_too_long((duration - done) / plan.n_steps, plan.scheme, rates))
      plan = plan_steps(parts.setup.scheme, rates, parts.setup.step, duration - done);

    FlowState& to = from == &start ? end : parts.spare;
    parts.shape(to);
    if (from == &end) to.rate = std::move(end.rate);  // no third copy: updated in place
    for (bool is_taken = false; !is_taken;) {
      const double dt = (duration - done) / plan.n_steps;
      if (dt < smallest_step) refuse_step(parts.block, *from, rates.diffusion > rates.courant, dt, smallest_step);
      parts.correction.place_bodies(from->time + dt, to);
      parts.predictor.predict(*from, dt, plan.scheme, to);
      const PressureCorrection::Result corrected = parts.correction.correct_step(*from, dt, to);
      // A flow that speeds up within the step, from rest say, takes it again in shorter ones.
      rates.courant = std::max(rates.courant, to.courant_rate);
      is_taken = !parts.is_too_long(dt, plan.scheme, rates);
      if (!is_taken) {
        plan = plan_steps(parts.setup.scheme, rates, parts.setup.step, duration - done);
        if (from == &end) end.rate_kind = RateKind::none;  // its memory was handed on and is spent
        continue;
      }
      if (plan.scheme == TimeScheme::crank_nicolson) parts.predictor.remember_acceleration(*from, dt, to);
      append(all, parts.report(*from, dt, plan.scheme, to, corrected));
      done = --plan.n_steps == 0 ? duration : done + dt;
    }
    if (&to == &parts.spare) std::swap(parts.spare, end);
    from = &end;
  }
  return all;
}

AdvanceReport FractionalStep::Parts::report(const FlowState& from, double dt, TimeScheme scheme, const FlowState& to,
                                            const PressureCorrection::Result& corrected) const {
  const SolveReport& solved = corrected.solved;
  return {.n_steps = 1,
          .smallest_step = dt,
          .courant = std::max(from.courant_rate, to.courant_rate) * dt,
          .largest_speed = to.largest_speed,
          .divergence = corrected.measure.divergence,
          .divergence_rms = corrected.measure.divergence_rms(),
          .pressure_iterations = solved.iterations,
          .pressure_residual = solved.source_norm > 0 ? solved.true_residual / solved.source_norm : 0,
          .net_inflow = border.net_inflow(),
          .scheme = name_of(scheme)};
}

FlowState FractionalStep::initial_state() {
  Parts& parts = *parts_;
  FlowState state;
  parts.shape(state);
  set_initial_flow(parts.setup, parts.block, parts.border, parts.ghosts, parts.correction, state);
  return state;
}

void FractionalStep::place_bodies(FlowState& state) {
  if (parts_->bodies) parts_->bodies->expect_jump();
  parts_->correction.place_bodies(state.time, state);
}

void FractionalStep::fill_ghosts(FlowState& state) {
  Parts& parts = *parts_;
  parts.border.set_pressure_time(state.pressure_time);
  parts.border.begin_step(state.velocity);
  parts.border.set_time(state.time, 0, state.velocity);
  parts.border.impose(state.velocity, false);
  parts.ghosts.fill(state);
  if (state.rate_kind == RateKind::mean_acceleration) parts.ghosts.fill_from_neighbours(state.rate);
  parts.correction.measure_speed(state);
}

void FractionalStep::Parts::shape(FlowState& state) const {
  if (state.pressure.sizes() != block.sizes || state.pressure.is_empty()) {
    state.pressure = block.new_field();
    state.velocity = block.new_vector_field();
  }
}

std::vector<SurfaceLoad> FractionalStep::body_loads(const FlowState& state) const {
  if (!state.bodies) return {};
  return BodyLoads(parts_->block, parts_->setup.viscosity).measure(state);
}

std::size_t FractionalStep::n_bytes() const {
  const Parts& parts = *parts_;
  std::size_t n = parts.predictor.n_bytes() + parts.correction.n_bytes() + parts.spare.pressure.n_bytes();
  for (int d = 0; d < 3; ++d) n += parts.spare.velocity[d].n_bytes() + parts.spare.rate[d].n_bytes();
  return n;
}

Traffic FractionalStep::traffic() const {
  const Parts& parts = *parts_;
  Traffic all = parts.predictor.traffic();
  all += parts.correction.traffic();
  all += parts.ghosts.traffic();
  all.reductions += parts.border.reductions();
  return all;
}

}  // namespace couplet::flow
