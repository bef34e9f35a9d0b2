#include "flow-server/navier_stokes/predictor.hpp"

#include <cmath>
#include <functional>

#include "flow-server/immersed/cut_momentum.hpp"
#include "flow-server/momentum/explicit_momentum.hpp"

namespace couplet::flow {

namespace {

/// Third-order low-storage Runge-Kutta [Wray 1986; in Spalart, Moser, Rogers, J. Comput. Phys. 96 (1991) 297-324]:
/// u_s = u_{s-1} + dt (gamma_s R_{s-1} + zeta_s R_{s-2}), time advancing by (gamma_s + zeta_s) dt.
constexpr std::array<double, 3> gamma{8.0 / 15, 5.0 / 12, 3.0 / 4};
constexpr std::array<double, 3> zeta{0, -17.0 / 60, -5.0 / 12};

/// Adams-Bashforth would extrapolate over more than this many steps before: such a step is taken by Runge-Kutta.
constexpr double largest_step_ratio = 2;

/// What the step before left behind: in the state it starts from, unless the memory was handed on.
const VectorField& rate_before(const FlowState& from, const FlowState& to) {
  return from.rate[0].is_empty() ? to.rate : from.rate;
}

}  // namespace

Predictor::Predictor(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border, FlowGhosts& ghosts,
                     ImmersedBodies* bodies)
    : setup_(setup),
      block_(block),
      border_(border),
      ghosts_(ghosts),
      bodies_(bodies),
      force_(block, setup.body_force, setup.density) {}

void Predictor::predict(const FlowState& from, double dt, TimeScheme scheme, FlowState& to) {
  border_.begin_step(from.velocity);
  border_.set_pressure_time(from.time + 0.5 * dt);
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

/// u* = u + dt [(1 + r/2) R(u_n) - r/2 R(u_{n-1}) - grad p / rho + f], r = dt_n / dt_{n-1}
void Predictor::predict_by_adams_bashforth(const FlowState& from, double dt, FlowState& to) {
  if (to.rate[0].is_empty()) to.rate = block_.new_vector_field();
  stage_ = VectorField{}, rate_ = VectorField{};  // what Runge-Kutta needed to start
  const double r = dt / from.last_step, middle = from.time + 0.5 * dt;
  const MomentumWeights weights{.now = (1 + 0.5 * r) * dt,
                                .before = -0.5 * r * dt,
                                .pressure = dt / setup_.density,
                                .impulse = force_.uniform_change(middle, dt),
                                .viscosity = setup_.kinematic_viscosity()};
  // A face that has come to another side of a wall remembers that side's rate: it takes the present one for it.
  std::vector<double> forgotten;
  if (from.bodies)
    for (const auto& [c, face, closed] : from.bodies->changed_faces)
      forgotten.push_back(rate_before(from, to)[c](face[0], face[1], face[2]));
  advance_momentum(block_, block_.everything(), weights, from.velocity, from.velocity, from.pressure,
                   &rate_before(from, to), &to.rate, to.velocity);
  if (from.bodies) {
    correct_cut_rows(block_, from.bodies->layer(), 1, weights.viscosity, weights.now, from.velocity, &to.rate,
                     to.velocity);
    for (std::size_t n = 0; n < forgotten.size(); ++n) {
      const auto& [c, face, closed] = from.bodies->changed_faces[n];
      to.velocity[c](face[0], face[1], face[2]) +=
          weights.before * closed * (to.rate[c](face[0], face[1], face[2]) - forgotten[n]);
    }
  }
  if (from.bodies) bodies_->forcing().mend_slopes(*from.bodies, dt / setup_.density, from.pressure, to.velocity);
  force_.add_varying(middle, dt, to.velocity);
  border_.add_pressure_change(dt / setup_.density, from.pressure, to.velocity);
  border_.set_time(from.time + dt, dt, from.velocity);
  border_.impose(to.velocity);
  to.rate_kind = RateKind::of_momentum;
}

/// Three stages with the pressure gradient of the step before and one projection at the end, second order in all [Le
/// and Moin, J. Comput. Phys. 92 (1991) 369-379].
void Predictor::predict_by_runge_kutta(const FlowState& from, double dt, bool keeps_rate, FlowState& to) {
  if (stage_[0].is_empty()) stage_ = block_.new_vector_field();
  if (rate_[0].is_empty()) rate_ = block_.new_vector_field();
  // The rate of the first stage is the memory of Adams-Bashforth.
  if (keeps_rate && to.rate[0].is_empty()) to.rate = block_.new_vector_field();
  VectorField& first_rate = keeps_rate ? to.rate : rate_;
  double elapsed = 0;
  for (std::size_t s = 0; s < 3; ++s) {
    const double part = (gamma[s] + zeta[s]) * dt, middle = from.time + elapsed + 0.5 * part;
    const MomentumWeights weights{.now = gamma[s] * dt,
                                  .before = zeta[s] * dt,
                                  .pressure = part / setup_.density,
                                  .impulse = force_.uniform_change(middle, part),
                                  .viscosity = setup_.kinematic_viscosity()};
    VectorField& fresh = s == 1 ? stage_ : to.velocity;
    if (s == 0) {
      advance_momentum(block_, block_.everything(), weights, from.velocity, from.velocity, from.pressure, nullptr,
                       &first_rate, fresh);
      if (from.bodies)
        correct_cut_rows(block_, from.bodies->layer(), 1, weights.viscosity, weights.now, from.velocity, &first_rate,
                         fresh);
    } else {
      VectorField& old = s == 1 ? to.velocity : stage_;
      const auto advance = [&](const Box& box) {
        advance_momentum(block_, box, weights, old, old, from.pressure, s == 1 ? &first_rate : &rate_,
                         s == 1 ? &rate_ : nullptr, fresh);
      };
      if (bodies_) {
        advance(block_.everything());  // walls that hold a stage fill its ghosts
      } else {
        ghosts_.while_filling(old, true, advance);
      }
      // Walls that have moved on: between the rates with those at the start and at the end of the step.
      const double share = elapsed / dt;
      if (from.bodies)
        for (const bool is_end : {false, true})
          correct_cut_rows(block_, (is_end ? to : from).bodies->layer(), is_end ? share : 1 - share, weights.viscosity,
                           weights.now, old, s == 1 ? &rate_ : nullptr, fresh);
      if (from.bodies) bodies_->forcing().release(fresh);
    }
    if (from.bodies) bodies_->forcing().mend_slopes(*from.bodies, part / setup_.density, from.pressure, fresh);
    force_.add_varying(middle, part, fresh);
    border_.add_pressure_change(part / setup_.density, from.pressure, fresh);
    elapsed += part;
    border_.set_time(s == 2 ? from.time + dt : from.time + elapsed, elapsed, from.velocity);
    border_.impose(fresh);
    if (bodies_ && s < 2)
      bodies_->forcing().hold(*from.bodies, *to.bodies, elapsed / dt, std::bind_front(&FlowGhosts::fill_deep, &ghosts_),
                              fresh);
  }
  to.rate_kind = keeps_rate ? RateKind::of_momentum : RateKind::none;
}

/// (1 + dt/2 L) (u* - u) = dt [-L u - grad p / rho + f], L being convection by U less diffusion and U the velocity
/// extrapolated to the middle of the step.
void Predictor::predict_by_crank_nicolson(const FlowState& from, double dt, FlowState& to) {
  if (!implicit_) implicit_ = std::make_unique<ImplicitMomentum>(block_, border_);
  if (stage_[0].is_empty()) stage_ = block_.new_vector_field();
  rate_ = VectorField{};
  VectorField& carrier = stage_;
  const bool extrapolates = from.rate_kind == RateKind::mean_acceleration;
  const double middle = from.time + 0.5 * dt;
  const MomentumWeights weights{.now = dt,
                                .before = 0,
                                .pressure = dt / setup_.density,
                                .impulse = force_.uniform_change(middle, dt),
                                .viscosity = setup_.kinematic_viscosity()};
  // Without memory the step is done twice, the second time with the mean of both velocities.
  for (int pass = extrapolates ? 1 : 0; pass < 2; ++pass) {
    if (extrapolates) {
      combine(from.velocity, 0.5 * dt, rate_before(from, to), carrier);
    } else if (pass == 0) {
      combine(from.velocity, 0, from.velocity, carrier);
    } else {
      ghosts_.fill(to.velocity);
      combine(from.velocity, -0.5, from.velocity, carrier);
      combine(carrier, 0.5, to.velocity, carrier);
    }
    border_.fill_velocity_ghosts(carrier);  // beyond openings
    border_.set_time(from.time, 0, from.velocity);
    border_.remember();
    border_.set_time(from.time + dt, dt, from.velocity);

    advance_momentum(block_, block_.everything(), weights, carrier, from.velocity, from.pressure, nullptr, nullptr,
                     to.velocity);
    force_.add_varying(middle, dt, to.velocity);
    border_.add_pressure_change(dt / setup_.density, from.pressure, to.velocity);
    damp_openings(dt, from, extrapolates ? &rate_before(from, to) : nullptr, to.velocity);
    border_.impose(to.velocity);
    combine(to.velocity, -1, from.velocity, to.velocity);
    implicit_->solve(0.5 * dt, setup_.kinematic_viscosity(), carrier, to.velocity);
    combine(to.velocity, 1, from.velocity, to.velocity);
  }
  to.rate_kind = RateKind::mean_acceleration;
}

/// Faces of an opening are no part of the lines. What their explicit change differs by from that of the step before is
/// divided by 1 + dt/2 times a bound of the eigenvalue of L there: stable with any step, second order in time once
/// there is a step before.
void Predictor::damp_openings(double dt, const FlowState& from, const VectorField* acceleration,
                              VectorField& velocity) const {
  for (int d = 0; d < block_.n_dimensions; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!border_.is_partly_open(d, side) || !block_.decomposition->is_at_border(d, side)) continue;
      Box face = box_of(block_.sizes);
      face.begin[d] = side == 0 ? -1 : block_.sizes[d] - 1;
      face.end[d] = face.begin[d] + 1;
      for (int k = face.begin[2]; k < face.end[2]; ++k)
        for (int j = face.begin[1]; j < face.end[1]; ++j)
          for (int i = face.begin[0]; i < face.end[0]; ++i) {
            const Triple cell{i, j, k};
            double bound = 0;
            for (int e = 0; e < block_.n_dimensions; ++e) {
              const int place = e == d && side == 0 ? 0 : cell[e];
              const double over = block_.axis[e].inverse_width[place];
              bound += 4 * setup_.kinematic_viscosity() * over * over +
                       (e == d ? 2 * std::abs(from.velocity[d](i, j, k)) * over : 0);
            }
            const double continued = from.velocity[d](i, j, k) + (acceleration ? dt * (*acceleration)[d](i, j, k) : 0);
            double& fresh = velocity[d](i, j, k);
            fresh = continued + (fresh - continued) / (1 + 0.5 * dt * bound);
          }
    }
}

void Predictor::remember_acceleration(const FlowState& from, double dt, FlowState& to) const {
  if (to.rate[0].is_empty()) to.rate = block_.new_vector_field();
  combine(to.velocity, -1, from.velocity, to.rate);
  combine(to.rate, 1 / dt - 1, to.rate, to.rate);
}

/// a + factor * b, ghosts included; the sum may be a or b.
void Predictor::combine(const VectorField& a, double factor, const VectorField& b, VectorField& sum) const {
  for (int d = 0; d < block_.n_dimensions; ++d) {
    const double* first = a[d].data();
    const double* second = b[d].data();
    double* result = sum[d].data();
    const std::size_t n = a[d].n_values();
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) result[i] = first[i] + factor * second[i];
  }
}

std::size_t Predictor::n_bytes() const {
  std::size_t n = implicit_ ? implicit_->n_bytes() : 0;
  for (int d = 0; d < 3; ++d) n += stage_[d].n_bytes() + rate_[d].n_bytes();
  return n;
}

Traffic Predictor::traffic() const {
  return implicit_ ? implicit_->traffic() : Traffic{};
}

}  // namespace couplet::flow
