// Claim: flow through a moving channel is second order in the time step, also with unequal steps and a moving exit
// line, and second order in the spacing of the stations.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "flow-server/one_dimensional/glottal_flow.hpp"

namespace couplet::flow {
namespace {

constexpr double pi = 3.14159265358979324;
constexpr double width = 0.02;          // [m]
constexpr double length = 0.012;        // [m]
constexpr double density = 1.13;        // [kg/m^3]
constexpr double omega = 2 * pi * 130;  // [rad/s]
constexpr double end_time = 0.004;      // [s], about half a period

/// An exact flow: an area and an inlet flow of our choice, the inlet pressure that drives it, and the velocity.
struct ExactFlow {
  std::function<double(double t)> exit;                     // x_b [m]
  std::function<double(double x, double t)> area;           // [m^2]
  std::function<double(double t)> inlet_rate;               // [m^3/s]
  std::function<double(double x, double t)> velocity;       // [m/s]
  std::function<double(double x, double t)> pressure_drop;  // p(0, t) - p(x, t) [Pa]
};

struct Errors {
  double rate = 0;      // largest of all times, relative
  double pressure = 0;  // largest at the end time [Pa]
};

GlottalLaw law_with_friction(double mu) {
  return {.model = GlottalModel::m1,
          .density = density,
          .viscosity = mu,
          .friction_coefficient = 2,
          .time_derivative = TimeDerivative::bdf2};
}

/// Drives the channel by the exact inlet pressure; step_of(share of the run that is done) scales each step, in the mean
/// by 1.
Errors run(const ExactFlow& exact, const GlottalLaw& law, int n_stations, int n_steps,
           const std::function<double(double)>& step_of) {
  const StationAxis axis(n_stations);
  GlottalFlow flow(axis, law);
  const auto profile = [&](double t) {
    SectionProfile p;
    p.exit = exact.exit(t);
    p.area = (axis.fraction() * p.exit).unaryExpr([&](double x) { return exact.area(x, t); });
    p.perimeter = 2 * (width + p.area / width);
    return p;
  };
  flow.start(profile(0), {exact.pressure_drop(exact.exit(0), 0), 0});
  Errors errors;
  double t = 0;
  for (int n = 0; n < n_steps; ++n) {
    const double step = step_of((n + 0.5) / n_steps) * end_time / n_steps;
    t += step;
    flow.solve(profile(t), {exact.pressure_drop(exact.exit(t), t), 0}, step);
    flow.accept();
    errors.rate = std::max(errors.rate, std::abs(flow.history().accepted.inlet_rate / exact.inlet_rate(t) - 1));
  }
  EXPECT_NEAR(t, end_time, 1e-12);
  const GlottalSolution& now = flow.history().accepted;
  for (int k = 0; k < n_stations; ++k) {
    const double p = exact.pressure_drop(now.exit, t) - exact.pressure_drop(now.position[k], t);
    errors.pressure = std::max(errors.pressure, std::abs(now.pressure[k] - p));
  }
  return errors;
}

double equal_steps(double) {
  return 1;
}
/// Between 0.6 and 1.4, changing little from one step to the next.
double drifting_steps(double share_of_run) {
  return 1 + 0.4 * std::sin(2 * pi * share_of_run);
}

/// Rises from 0 to 1 in half a period; it and its first two derivatives vanish at t = 0, so that the flow starts
/// steady.
double swing(double t) {
  return std::pow(1 - std::cos(omega * t), 2) / 4;
}
double swing_t(double t) {
  return omega * (1 - std::cos(omega * t)) * std::sin(omega * t) / 2;
}
double swing_tt(double t) {
  return omega * omega * (std::pow(std::sin(omega * t), 2) + (1 - std::cos(omega * t)) * std::cos(omega * t)) / 2;
}

/// A straight channel whose height breathes: u = (Q - w h' x) / (w h), all in closed form.
ExactFlow breathing_slit(double mu) {
  const double h0 = 1e-3, a = 0.4, Q0 = 2e-4;
  const auto h = [=](double t) { return h0 * (1 + a * swing(t)); };
  const auto h_t = [=](double t) { return h0 * a * swing_t(t); };
  const auto h_tt = [=](double t) { return h0 * a * swing_tt(t); };
  const auto Q = [=](double t) { return Q0 * (1 + 0.6 * swing(t)); };
  const auto Q_t = [=](double t) { return Q0 * 0.6 * swing_t(t); };
  ExactFlow exact;
  exact.exit = [](double) { return length; };
  exact.area = [=](double, double t) { return width * h(t); };
  exact.inlet_rate = Q;
  exact.velocity = [=](double x, double t) { return (Q(t) - width * h_t(t) * x) / (width * h(t)); };
  exact.pressure_drop = [=](double x, double t) {
    // u = alpha + beta x; p_x = - rho (u_t + u u_x) - f u
    const double alpha = Q(t) / (width * h(t)), beta = -h_t(t) / h(t);
    const double alpha_t = Q_t(t) / (width * h(t)) - alpha * h_t(t) / h(t);
    const double beta_t = -h_tt(t) / h(t) + beta * beta;
    const double s_over_A = 2 * (width + h(t)) / (width * h(t));
    const double f = 2 * mu * s_over_A * s_over_A;
    return density * ((alpha_t + alpha * beta) * x + (beta_t + beta * beta) * x * x / 2) +
           f * (alpha * x + beta * x * x / 2);
  };
  return exact;
}

/// A wedge that breathes, A = w H(t) (1 - c x / L), with the inertia integral by Gauss points to round-off.
ExactFlow breathing_wedge(std::function<double(double)> exit) {
  const double h0 = 2e-3, a = 0.4, c = 0.7 / length, Q0 = 2e-4;
  const auto h = [=](double t) { return h0 * (1 + a * swing(t)); };
  const auto h_t = [=](double t) { return h0 * a * swing_t(t); };
  const auto h_tt = [=](double t) { return h0 * a * swing_tt(t); };
  const auto Q = [=](double t) { return Q0 * (1 + 0.6 * swing(t)); };
  const auto Q_t = [=](double t) { return Q0 * 0.6 * swing_t(t); };
  const auto volume = [=](double x) { return width * (x - c * x * x / 2); };  // times H
  const auto area = [=](double x, double t) { return width * h(t) * (1 - c * x); };
  const auto u = [=](double x, double t) { return (Q(t) - h_t(t) * volume(x)) / area(x, t); };
  const auto u_t = [=](double x, double t) {
    return (Q_t(t) - h_tt(t) * volume(x)) / area(x, t) - u(x, t) * h_t(t) / h(t);
  };
  ExactFlow exact;
  exact.exit = std::move(exit);
  exact.area = area;
  exact.inlet_rate = Q;
  exact.velocity = u;
  exact.pressure_drop = [=](double x, double t) {
    double inertia = 0;
    const int n = 64;  // panels of three Gauss points: error below 1e-12 for this smooth integrand
    for (int i = 0; i < n; ++i) {
      const double middle = x * (i + 0.5) / n, half = x * 0.5 / n;
      inertia += half *
                 (5 * u_t(middle - std::sqrt(0.6) * half, t) + 8 * u_t(middle, t) +
                  5 * u_t(middle + std::sqrt(0.6) * half, t)) /
                 9;
    }
    return density * (inertia + (u(x, t) * u(x, t) - u(0, t) * u(0, t)) / 2);
  };
  return exact;
}

/// Errors fall by at least `factor` whenever the number of steps (and of stations, when `refine_stations`) doubles.
void expect_falling_errors(const ExactFlow& exact, const GlottalLaw& law, bool refine_stations,
                           const std::function<double(double)>& step_of, double factor) {
  Errors last;
  for (const int n : {40, 80, 160, 320}) {
    const Errors now = run(exact, law, refine_stations ? n + 1 : 41, n, step_of);
    if (last.rate > 0) {
      EXPECT_GT(last.rate / now.rate, factor) << n << " steps";
      EXPECT_GT(last.pressure / now.pressure, factor) << n << " steps";
    }
    last = now;
  }
  EXPECT_LT(last.rate, factor > 3 ? 1e-3 : 2e-2);  // a first-order error falls by 8 over the three halvings
}

// The limit is 4; the coarsest step, a hundredth of half a period, is not quite there yet.
constexpr double second_order = 3.6;
// The limit is 2.
constexpr double first_order = 1.8;

TEST(MovingChannel, WithBackwardEulerTheErrorFallsWithTheStep) {
  GlottalLaw law = law_with_friction(2.27e-4);
  law.time_derivative = TimeDerivative::backward_euler;
  expect_falling_errors(breathing_slit(2.27e-4), law, false, equal_steps, first_order);
}

TEST(MovingChannel, ABreathingSlitConvergesWithTheSquareOfTheStep) {
  expect_falling_errors(breathing_slit(2.27e-4), law_with_friction(2.27e-4), false, equal_steps, second_order);
}

TEST(MovingChannel, ABreathingSlitConvergesWithTheSquareOfStepsThatDrift) {
  expect_falling_errors(breathing_slit(2.27e-4), law_with_friction(2.27e-4), false, drifting_steps, second_order);
}

TEST(MovingChannel, ABreathingWedgeConvergesWithTheSquareOfStepAndSpacing) {
  expect_falling_errors(breathing_wedge([](double) { return length; }), law_with_friction(0), true, equal_steps,
                        second_order);
}

TEST(MovingChannel, StationsThatMoveWithTheExitLineKeepTheOrder) {
  const auto exit = [](double t) { return length * (1 - 0.15 * swing(t)); };
  expect_falling_errors(breathing_wedge(exit), law_with_friction(0), true, equal_steps, second_order);
}

TEST(MovingChannel, OverAClosedCycleWhatCameInWentOut) {
  // A sum of rates of change over a whole period of a periodic motion vanishes, whatever the step.
  const StationAxis axis(60);
  for (const int n_steps : {100, 200, 400}) {
    GlottalFlow flow(axis, law_with_friction(2.27e-4));
    const double period = 2 * pi / omega, step = period / n_steps;
    const auto profile = [&](double t) {
      SectionProfile p;
      p.exit = length;
      p.area = width * (1e-3 + 10 * (axis.fraction() * length - 0.01).square()) * (1 + 0.5 * std::sin(omega * t));
      p.perimeter = 2 * (width + p.area / width);
      return p;
    };
    flow.start(profile(0), {500, 0});
    double in = 0, out = 0;
    for (int n = 1; n <= 2 * n_steps; ++n) {
      flow.solve(profile(n * step), {500, 0}, step);
      flow.accept();
      if (n <= n_steps) continue;  // the first cycle is the transient
      in += step * flow.history().accepted.inlet_rate;
      out += step * flow.history().accepted.exit_rate;
    }
    const double leak = std::abs(in - out) / in;
    EXPECT_LT(leak, 1e-12) << n_steps;  // round-off of 400 sums
  }
}

}  // namespace
}  // namespace couplet::flow
