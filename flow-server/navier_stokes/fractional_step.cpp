#include "flow-server/navier_stokes/fractional_step.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/momentum/explicit_momentum.hpp"
#include "flow-server/momentum/implicit_momentum.hpp"
#include "flow-server/navier_stokes/flow_domain.hpp"
#include "flow-server/navier_stokes/flow_failure.hpp"
#include "flow-server/navier_stokes/projection.hpp"
#include "flow-server/navier_stokes/step_limit.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using VectorField = std::array<Field<double>, 3>;

/// Third-order low-storage Runge-Kutta [Wray 1986; in Spalart, Moser, Rogers, J. Comput. Phys. 96 (1991) 297-324]:
/// u_s = u_{s-1} + dt (gamma_s R_{s-1} + zeta_s R_{s-2}), time advancing by (gamma_s + zeta_s) dt.
constexpr std::array<double, 3> gamma{8.0 / 15, 5.0 / 12, 3.0 / 4};
constexpr std::array<double, 3> zeta{0, -17.0 / 60, -5.0 / 12};

/// Adams-Bashforth would extrapolate over more than this many steps before: such a step is taken by Runge-Kutta.
constexpr double largest_step_ratio = 2;

/// An interval that asks for more steps than a million will not end: the flow has blown up.
constexpr double shortest_share = 1e-6;

/// Initial fields are free of divergence almost to round-off.
constexpr double initial_tolerance = 1e-10;
constexpr int initial_iterations = 200;

/// Largest |div u| times the smallest width over the largest speed that a projection may leave.
constexpr double largest_divergence = 0.05;
/// A flow with smaller Courant numbers is at rest: what moves is round-off of forces that balance.
constexpr double courant_at_rest = 1e-8;

std::string text(double value) {
  std::ostringstream out;
  out.precision(6);
  out << value;
  return out.str();
}

const NavierStokesSetup& checked(const NavierStokesSetup& setup, const BlockDecomposition& decomposition) {
  const auto refuse = [](const std::string& where, double value, const std::string& unit, const std::string& advice) {
    throw report::SceneError(where, "is " + text(value) + " " + unit, advice);
  };
  if (!(setup.density > 0) || !std::isfinite(setup.density))
    refuse("density of the fluid", setup.density, "kg/m^3", "give a positive number");
  if (!(setup.viscosity >= 0) || !std::isfinite(setup.viscosity))
    refuse("viscosity of the fluid", setup.viscosity, "Pa s", "give 0 or a positive number");
  if (!(setup.step.largest > 0)) refuse("largest step", setup.step.largest, "s", "give a positive number");
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
        border(checked(setup, blocks).grid, blocks, setup.border, setup.is_fluid, setup.balances_inflow),
        block(make_flow_block(setup, blocks, border)),
        exchange(blocks),
        problem(make_pressure_problem(setup, block, border)),
        solver(make_pressure_solver(problem, setup.pressure.method)),
        source(block.new_field()),
        phi(block.new_field()),
        nu(setup.viscosity / setup.density),
        diffusion(diffusion_rate(setup.grid, nu)) {
    inner = box_of(block.sizes);
    for (int d = 0; d < block.n_dimensions; ++d) {
      ++inner.begin[d], --inner.end[d];
      smallest_width = std::min(smallest_width, setup.grid.axis[d].smallest_width());
    }
    if (inner.is_empty()) inner = {};
    for (int n = 0; n < 27; ++n) {
      const int rank = blocks.neighbour({n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1});
      has_other_ranks |= rank != MPI_PROC_NULL && rank != blocks.rank();
    }
  }

  void shape(FlowState& state) const;
  void measure_speed(FlowState& state);
  void predict(const FlowState& from, double dt, TimeScheme scheme, FlowState& to);
  void predict_by_adams_bashforth(const FlowState& from, double dt, FlowState& to);
  void predict_by_runge_kutta(const FlowState& from, double dt, bool keeps_rate, FlowState& to);
  void predict_by_crank_nicolson(const FlowState& from, double dt, FlowState& to);
  const VectorField& rate_before(const FlowState& from, const FlowState& to) const;
  void damp_openings(double dt, const FlowState& from, VectorField& velocity) const;
  void combine(const VectorField& a, double factor, const VectorField& b, VectorField& sum) const;
  AdvanceReport project(const FlowState& from, double dt, FlowState& to);
  void take_divergence_of(VectorField& velocity, double factor);
  SolveReport solve_pressure(const SolveLimits& limits);
  void finish_state(FlowState& state);
  void set_initial_velocity(FlowState& state);
  void find_initial_pressure(FlowState& state);

  Box everything() const { return box_of(block.sizes).grown({1, 1, 1}); }
  std::array<double, 3> impulse(double time, double weight) const;
  void add_force(double time, double weight, bool with_uniform, VectorField& velocity) const;
  template <class Work>
  void around_exchange(VectorField& fields, bool needs_border_ghosts, const Work& work);
  std::vector<Field<double>*> pointers(VectorField& fields) const;

  NavierStokesSetup setup;
  const BlockDecomposition& decomposition;
  FlowBorder border;
  FlowBlock block;
  HaloExchange exchange;
  PressureProblem problem;  // outlives its solver
  std::unique_ptr<PressureSolver> solver;
  Field<double> source, phi;
  double nu, diffusion;
  double smallest_width = std::numeric_limits<double>::infinity();
  Box inner;  // cells whose stencils need no ghosts
  bool has_other_ranks = false;
  std::unique_ptr<ImplicitMomentum> implicit;  // Crank-Nicolson only
  VectorField stage;                           // of Runge-Kutta; the convecting velocity of Crank-Nicolson
  VectorField rate;                            // of Runge-Kutta
  FlowState spare;                             // of several steps in one interval
  std::int64_t n_reductions = 0;
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
    const StepRates rates{from->courant_rate, parts.diffusion};
    if (plan.n_steps == 0 ||
        (duration - done) / plan.n_steps > 1.2 * longest_step(plan.scheme, rates, parts.setup.step))
      plan = plan_steps(parts.setup.scheme, rates, parts.setup.step, duration - done);
    const double dt = (duration - done) / plan.n_steps;
    if (dt < smallest_step) refuse_step(parts.block, *from, dt, smallest_step);

    FlowState& to = from == &start ? end : parts.spare;
    parts.shape(to);
    if (from == &end) to.rate = std::move(end.rate);  // no third copy: updated in place
    parts.predict(*from, dt, plan.scheme, to);
    AdvanceReport step = parts.project(*from, dt, to);
    if (&to == &parts.spare) std::swap(parts.spare, end);

    from = &end;
    done = --plan.n_steps == 0 ? duration : done + dt;
    step.scheme = name_of(plan.scheme);
    append(all, step);
  }
  return all;
}

/// The velocity of the end of the step but for its divergence: with the pressure gradient of the step before. Leaves in
/// the end state what the scheme will want to know of this step.
void FractionalStep::Parts::predict(const FlowState& from, double dt, TimeScheme scheme, FlowState& to) {
  border.begin_step(from.velocity);
  border.set_pressure_time(from.time + 0.5 * dt);
  // Without memory, or where the step has grown a lot, Adams-Bashforth starts anew.
  const bool extrapolates = from.rate_kind == RateKind::of_momentum && dt <= largest_step_ratio * from.last_step;
  if (scheme == TimeScheme::crank_nicolson) {
    predict_by_crank_nicolson(from, dt, to);
  } else if (scheme == TimeScheme::adams_bashforth && extrapolates) {
    predict_by_adams_bashforth(from, dt, to);
  } else {
    predict_by_runge_kutta(from, dt, scheme == TimeScheme::adams_bashforth, to);
  }
}

/// What the step before left behind: in the state it starts from, unless the memory was handed on.
const VectorField& FractionalStep::Parts::rate_before(const FlowState& from, const FlowState& to) const {
  return from.rate[0].is_empty() ? to.rate : from.rate;
}

/// u* = u + dt [(1 + r/2) R(u_n) - r/2 R(u_{n-1}) - grad p / rho + f], r = dt_n / dt_{n-1}
void FractionalStep::Parts::predict_by_adams_bashforth(const FlowState& from, double dt, FlowState& to) {
  if (to.rate[0].is_empty()) to.rate = block.new_vector_field();
  stage = VectorField{}, rate = VectorField{};  // what Runge-Kutta needed to start
  const double r = dt / from.last_step, middle = from.time + 0.5 * dt;
  const MomentumWeights weights{.now = (1 + 0.5 * r) * dt,
                                .before = -0.5 * r * dt,
                                .pressure = dt / setup.density,
                                .impulse = impulse(middle, dt),
                                .viscosity = nu};
  advance_momentum(block, everything(), weights, from.velocity, from.velocity, from.pressure, &rate_before(from, to),
                   &to.rate, to.velocity);
  add_force(middle, dt, false, to.velocity);
  border.add_pressure_change(dt / setup.density, from.pressure, to.velocity);
  border.set_time(from.time + dt, dt, from.velocity);
  border.impose(to.velocity);
  to.rate_kind = RateKind::of_momentum;
}

/// Three stages with the pressure gradient of the step before and one projection at the end, second order in all [Le
/// and Moin, J. Comput. Phys. 92 (1991) 369-379].
void FractionalStep::Parts::predict_by_runge_kutta(const FlowState& from, double dt, bool keeps_rate, FlowState& to) {
  if (stage[0].is_empty()) stage = block.new_vector_field();
  if (rate[0].is_empty()) rate = block.new_vector_field();
  // The rate of the first stage is the memory of Adams-Bashforth.
  if (keeps_rate && to.rate[0].is_empty()) to.rate = block.new_vector_field();
  VectorField& first_rate = keeps_rate ? to.rate : rate;
  double elapsed = 0;
  for (std::size_t s = 0; s < 3; ++s) {
    const double part = (gamma[s] + zeta[s]) * dt, middle = from.time + elapsed + 0.5 * part;
    const MomentumWeights weights{.now = gamma[s] * dt,
                                  .before = zeta[s] * dt,
                                  .pressure = part / setup.density,
                                  .impulse = impulse(middle, part),
                                  .viscosity = nu};
    VectorField& fresh = s == 1 ? stage : to.velocity;
    if (s == 0) {
      advance_momentum(block, everything(), weights, from.velocity, from.velocity, from.pressure, nullptr, &first_rate,
                       fresh);
    } else {
      VectorField& old = s == 1 ? to.velocity : stage;
      around_exchange(old, true, [&](const Box& box) {
        advance_momentum(block, box, weights, old, old, from.pressure, s == 1 ? &first_rate : &rate,
                         s == 1 ? &rate : nullptr, fresh);
      });
    }
    add_force(middle, part, false, fresh);
    border.add_pressure_change(part / setup.density, from.pressure, fresh);
    elapsed += part;
    border.set_time(s == 2 ? from.time + dt : from.time + elapsed, elapsed, from.velocity);
    border.impose(fresh);
  }
  to.rate_kind = keeps_rate ? RateKind::of_momentum : RateKind::none;
}

/// (1 + dt/2 L) (u* - u) = dt [-L u - grad p / rho + f], L being convection by U less diffusion and U the velocity
/// extrapolated to the middle of the step.
void FractionalStep::Parts::predict_by_crank_nicolson(const FlowState& from, double dt, FlowState& to) {
  if (!implicit) implicit = std::make_unique<ImplicitMomentum>(block, border);
  if (stage[0].is_empty()) stage = block.new_vector_field();
  rate = VectorField{};
  VectorField& carrier = stage;
  const bool extrapolates = from.rate_kind == RateKind::mean_acceleration;
  const double middle = from.time + 0.5 * dt;
  const MomentumWeights weights{
      .now = dt, .before = 0, .pressure = dt / setup.density, .impulse = impulse(middle, dt), .viscosity = nu};
  // Without memory the step is done twice, the second time with the mean of both velocities.
  for (int pass = extrapolates ? 1 : 0; pass < 2; ++pass) {
    if (extrapolates) {
      combine(from.velocity, 0.5 * dt, rate_before(from, to), carrier);
    } else if (pass == 0) {
      combine(from.velocity, 0, from.velocity, carrier);
    } else {
      exchange.exchange(pointers(to.velocity), 1);
      border.fill_velocity_ghosts(to.velocity);
      combine(from.velocity, -0.5, from.velocity, carrier);
      combine(carrier, 0.5, to.velocity, carrier);
    }
    border.fill_velocity_ghosts(carrier);  // beyond openings
    border.set_time(from.time, 0, from.velocity);
    border.remember();
    border.set_time(from.time + dt, dt, from.velocity);

    advance_momentum(block, everything(), weights, carrier, from.velocity, from.pressure, nullptr, nullptr,
                     to.velocity);
    add_force(middle, dt, false, to.velocity);
    border.add_pressure_change(dt / setup.density, from.pressure, to.velocity);
    damp_openings(dt, from, to.velocity);
    border.impose(to.velocity);
    combine(to.velocity, -1, from.velocity, to.velocity);
    implicit->solve(0.5 * dt, nu, carrier, to.velocity);
    combine(to.velocity, 1, from.velocity, to.velocity);
  }
  to.rate_kind = RateKind::mean_acceleration;
}

/// Faces of an opening are no part of the lines: they take the explicit change over 1 + dt/2 times a bound of the
/// eigenvalue of L there, which is stable with any step and first order in time on these faces.
void FractionalStep::Parts::damp_openings(double dt, const FlowState& from, VectorField& velocity) const {
  for (int d = 0; d < block.n_dimensions; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!border.is_partly_open(d, side) || !decomposition.is_at_border(d, side)) continue;
      Box face = box_of(block.sizes);
      face.begin[d] = side == 0 ? -1 : block.sizes[d] - 1;
      face.end[d] = face.begin[d] + 1;
      for (int k = face.begin[2]; k < face.end[2]; ++k)
        for (int j = face.begin[1]; j < face.end[1]; ++j)
          for (int i = face.begin[0]; i < face.end[0]; ++i) {
            const Triple cell{i, j, k};
            double bound = 0;
            for (int e = 0; e < block.n_dimensions; ++e) {
              const int place = e == d && side == 0 ? 0 : cell[e];
              const double over = block.axis[e].inverse_width[place];
              bound += 4 * nu * over * over + (e == d ? 2 * std::abs(from.velocity[d](i, j, k)) * over : 0);
            }
            const double old = from.velocity[d](i, j, k);
            double& fresh = velocity[d](i, j, k);
            fresh = old + (fresh - old) / (1 + 0.5 * dt * bound);
          }
    }
}

/// div grad phi = rho div u* / dt, u = u* - dt / rho grad phi, p += phi
AdvanceReport FractionalStep::Parts::project(const FlowState& from, double dt, FlowState& to) {
  take_divergence_of(to.velocity, setup.density / dt);
  const double speed_at_rest = courant_at_rest * smallest_width / dt;
  const double speed = std::max(from.largest_speed, speed_at_rest);
  const double source_of_tolerance = setup.pressure.divergence_tolerance * speed / smallest_width * setup.density / dt;
  SolveReport solved;
  try {
    solved =
        solve_pressure({setup.pressure.relative_tolerance, source_of_tolerance, setup.pressure.largest_iterations});
  } catch (const report::NumericsError&) {
    require_finite(block, to.velocity, from.time + dt);  // a better sentence, where that is the reason
    throw;
  }
  // With implicit diffusion p += phi - mu/2 div u*: u* has felt the gradient of phi less than u has [D. L. Brown,
  // R. Cortez, M. L. Minion, J. Comput. Phys. 168 (2001) 464-499, eq. 72].
  const double viscous_factor = to.rate_kind == RateKind::mean_acceleration ? 0.5 * nu * dt : 0;
  const FlowMeasure measure =
      reduce(correct(block, dt / setup.density, phi, viscous_factor, source, from.pressure, to.pressure, to.velocity),
             decomposition.communicator());
  n_reductions += 2;
  to.time = from.time + dt;
  to.pressure_time = from.time + 0.5 * dt;
  to.last_step = dt;
  to.courant_rate = measure.courant_rate;
  to.largest_speed = measure.speed;
  finish_state(to);
  if (to.rate_kind == RateKind::mean_acceleration) {
    if (to.rate[0].is_empty()) to.rate = block.new_vector_field();
    combine(to.velocity, -1, from.velocity, to.rate);
    combine(to.rate, 1 / dt - 1, to.rate, to.rate);
  }

  if (!std::isfinite(measure.divergence_sum)) require_finite(block, to.velocity, to.time);
  if (measure.divergence * smallest_width > largest_divergence * std::max(measure.speed, speed_at_rest))
    throw report::NumericsError("pressure at t = " + text(to.time) + " s",
                                "leaves a divergence of " + text(measure.divergence) + " 1/s in a flow of " +
                                    text(measure.speed) + " m/s on cells of " + text(smallest_width) + " m",
                                "allow more iterations, a smaller tolerance or a smaller step");
  return {.n_steps = 1,
          .smallest_step = dt,
          .courant = std::max(from.courant_rate, to.courant_rate) * dt,
          .largest_speed = measure.speed,
          .divergence = measure.divergence,
          .divergence_rms = measure.divergence_rms(),
          .pressure_iterations = solved.iterations,
          .pressure_residual = solved.source_norm > 0 ? solved.true_residual / solved.source_norm : 0,
          .net_inflow = border.net_inflow(),
          .scheme = {}};
}

void FractionalStep::Parts::take_divergence_of(VectorField& velocity, double factor) {
  around_exchange(velocity, false, [&](const Box& box) { take_divergence(block, box, factor, velocity, source); });
}

/// phi from source, from nothing: equal steps give equal bits.
SolveReport FractionalStep::Parts::solve_pressure(const SolveLimits& limits) {
  std::fill(phi.data(), phi.data() + phi.n_values(), 0.0);
  const SolveReport solved = solver->solve(source, phi, limits);
  border.fill_increment_ghosts(phi);
  return solved;
}

/// Fills the ghosts of a state whose border values are those of its time.
void FractionalStep::Parts::finish_state(FlowState& state) {
  std::vector<Field<double>*> fields = pointers(state.velocity);
  fields.push_back(&state.pressure);
  exchange.exchange(fields, 1);
  border.begin_step(state.velocity);
  border.fill_velocity_ghosts(state.velocity);
  border.fill_pressure_ghosts(state.pressure);
}

FlowState FractionalStep::initial_state() {
  Parts& parts = *parts_;
  FlowState state;
  parts.shape(state);
  parts.set_initial_velocity(state);
  parts.find_initial_pressure(state);
  return state;
}

void FractionalStep::fill_ghosts(FlowState& state) {
  Parts& parts = *parts_;
  parts.border.set_pressure_time(state.pressure_time);
  parts.border.begin_step(state.velocity);
  parts.border.set_time(state.time, 0, state.velocity);
  parts.border.impose(state.velocity, false);
  parts.finish_state(state);
  if (state.rate_kind == RateKind::mean_acceleration) parts.exchange.exchange(parts.pointers(state.rate), 1);
  parts.measure_speed(state);
}

/// The given velocity, projected: u -= grad phi with div grad phi = div u.
void FractionalStep::Parts::set_initial_velocity(FlowState& state) {
  const Triple& origin = decomposition.mine().begin;
  for (int d = 0; d < block.n_dimensions; ++d) {
    const Box box = block.computed_faces(d);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const Triple cell{i, j, k};
          const bool is_on_border =
              (cell[d] == -1) || (cell[d] == block.sizes[d] - 1 && decomposition.is_at_border(d, 1));
          if (!is_on_border && !block.faces[d].contains(i, j, k)) continue;
          Point place;
          for (int e = 0; e < 3; ++e)
            place[e] = e == d ? setup.grid.axis[e].face(origin[e] + cell[e] + 1)
                              : setup.grid.axis[e].centre(origin[e] + cell[e]);
          state.velocity[d](i, j, k) = setup.initial_velocity[d].at(place, 0);
        }
  }
  border.set_pressure_time(0);
  border.begin_step(state.velocity);
  border.set_time(0, 0, state.velocity);
  border.impose(state.velocity);
  take_divergence_of(state.velocity, 1);
  const FlowMeasure given = reduce(measure(block, state.velocity), decomposition.communicator());
  if (!std::isfinite(given.divergence_sum)) require_finite(block, state.velocity, 0);
  solve_pressure(
      {initial_tolerance, setup.pressure.divergence_tolerance * given.speed / smallest_width, initial_iterations});
  const FlowMeasure measured = reduce(correct(block, 1, phi, 0, source, state.pressure, state.pressure, state.velocity),
                                      decomposition.communicator());
  n_reductions += 4;
  state.courant_rate = measured.courant_rate;
  state.largest_speed = measured.speed;
}

/// The pressure given, or, where it is 0, that which keeps the flow free of divergence: div grad p = rho div(du/dt by
/// everything else), with it the first step is as exact as all others.
void FractionalStep::Parts::find_initial_pressure(FlowState& state) {
  std::fill(state.pressure.data(), state.pressure.data() + state.pressure.n_values(), 0.0);
  const bool is_given = setup.initial_pressure.varies_in_space() || setup.initial_pressure.varies_in_time() ||
                        setup.initial_pressure.at({}, 0) != 0;
  if (is_given) {
    const Triple& origin = decomposition.mine().begin;
    for (int k = 0; k < block.sizes[2]; ++k)
      for (int j = 0; j < block.sizes[1]; ++j)
        for_each_interval(block.cells, j, k, 0, block.sizes[0], [&](int begin, int end) {
          for (int i = begin; i < end; ++i)
            state.pressure(i, j, k) = setup.initial_pressure.at(
                {setup.grid.axis[0].centre(origin[0] + i), setup.grid.axis[1].centre(origin[1] + j),
                 setup.grid.axis[2].centre(origin[2] + k)},
                0);
        });
    finish_state(state);
    return;
  }
  exchange.exchange(pointers(state.velocity), 1);
  border.fill_velocity_ghosts(state.velocity);
  stage = block.new_vector_field();
  rate = block.new_vector_field();
  VectorField& slope = stage;
  const MomentumWeights weights{.now = 1, .before = 0, .pressure = 0, .impulse = {}, .viscosity = nu};
  advance_momentum(block, everything(), weights, state.velocity, state.velocity, state.pressure, nullptr, &slope, rate);
  add_force(0, 1, true, slope);
  border.add_pressure_change(1 / setup.density, state.pressure, slope);
  // Known velocities of the border: their change over a time that is short for the flow.
  const double step = longest_step(TimeScheme::runge_kutta, {state.courant_rate, diffusion}, {});
  border.impose_rate(0, std::isfinite(step) ? 1e-3 * step : 1e-6, state.velocity, slope);
  take_divergence_of(slope, setup.density);
  solve_pressure({initial_tolerance, 0, initial_iterations});
  for (int k = 0; k < block.sizes[2]; ++k)
    for (int j = 0; j < block.sizes[1]; ++j)
      for_each_interval(block.cells, j, k, 0, block.sizes[0], [&](int begin, int end) {
        std::copy(phi.row(j, k) + begin, phi.row(j, k) + end, state.pressure.row(j, k) + begin);
      });
  finish_state(state);
}

void FractionalStep::Parts::shape(FlowState& state) const {
  if (state.pressure.sizes() != block.sizes || state.pressure.is_empty()) {
    state.pressure = block.new_field();
    state.velocity = block.new_vector_field();
  }
}

/// Collective: what the steps from this state on are planned with.
void FractionalStep::Parts::measure_speed(FlowState& state) {
  const FlowMeasure measured = reduce(measure(block, state.velocity), decomposition.communicator());
  n_reductions += 2;
  if (!std::isfinite(measured.divergence_sum)) require_finite(block, state.velocity, state.time);
  state.courant_rate = measured.courant_rate;
  state.largest_speed = measured.speed;
}

/// Calls work(box) for boxes that together hold everything once; those at the surface after the ghosts have come.
template <class Work>
void FractionalStep::Parts::around_exchange(VectorField& fields, bool needs_border_ghosts, const Work& work) {
  const Box all = everything();
  const Box early = has_other_ranks ? inner : Box{};
  exchange.start(pointers(fields), 1);
  if (!early.is_empty()) work(early);
  exchange.finish(pointers(fields));
  if (needs_border_ghosts) border.fill_velocity_ghosts(fields);
  if (early.is_empty()) return work(all);
  Box rest = all;
  for (int d = 2; d >= 0; --d) {
    Box low = rest, high = rest;
    low.end[d] = early.begin[d];
    high.begin[d] = early.end[d];
    work(low);
    work(high);
    rest.begin[d] = early.begin[d], rest.end[d] = early.end[d];
  }
}

/// The part of a force that is the same everywhere.
std::array<double, 3> FractionalStep::Parts::impulse(double time, double weight) const {
  std::array<double, 3> result{};
  for (int d = 0; d < block.n_dimensions; ++d)
    if (!setup.body_force[d].varies_in_space()) result[d] = weight / setup.density * setup.body_force[d].at({}, time);
  return result;
}

void FractionalStep::Parts::add_force(double time, double weight, bool with_uniform, VectorField& velocity) const {
  const Triple& origin = decomposition.mine().begin;
  for (int d = 0; d < block.n_dimensions; ++d) {
    const SpaceTimeValue& force = setup.body_force[d];
    if (!force.varies_in_space() && (!with_uniform || force.at({}, time) == 0)) continue;
    const Box box = block.computed_faces(d);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for_each_interval(block.faces[d], j, k, box.begin[0], box.end[0], [&](int begin, int end) {
          for (int i = begin; i < end; ++i) {
            const Triple cell{i, j, k};
            Point place;
            for (int e = 0; e < 3; ++e)
              place[e] = e == d ? setup.grid.axis[e].face(origin[e] + cell[e] + 1)
                                : setup.grid.axis[e].centre(origin[e] + cell[e]);
            velocity[d](i, j, k) += weight / setup.density * force.at(place, time);
          }
        });
  }
}

/// a + factor * b, ghosts included; the sum may be a or b.
void FractionalStep::Parts::combine(const VectorField& a, double factor, const VectorField& b, VectorField& sum) const {
  for (int d = 0; d < block.n_dimensions; ++d) {
    const double* first = a[d].data();
    const double* second = b[d].data();
    double* result = sum[d].data();
    const std::size_t n = a[d].n_values();
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) result[i] = first[i] + factor * second[i];
  }
}

std::vector<Field<double>*> FractionalStep::Parts::pointers(VectorField& fields) const {
  std::vector<Field<double>*> result;
  for (int d = 0; d < block.n_dimensions; ++d) result.push_back(&fields[d]);
  return result;
}

std::size_t FractionalStep::n_bytes() const {
  const Parts& parts = *parts_;
  std::size_t n = parts.implicit ? parts.implicit->n_bytes() : 0;
  n += parts.solver->n_bytes() + parts.source.n_bytes() + parts.phi.n_bytes() + parts.spare.pressure.n_bytes();
  for (int d = 0; d < 3; ++d)
    n += parts.stage[d].n_bytes() + parts.rate[d].n_bytes() + parts.spare.velocity[d].n_bytes() +
         parts.spare.rate[d].n_bytes();
  return n;
}

Traffic FractionalStep::traffic() const {
  const Parts& parts = *parts_;
  Traffic all = parts.solver->traffic();
  all += parts.exchange.traffic();
  if (parts.implicit) all += parts.implicit->traffic();
  all.reductions += parts.n_reductions + parts.border.reductions();
  return all;
}

}  // namespace couplet::flow
