#include "solid-server/choose_time_method.hpp"

#include <chrono>
#include <cmath>
#include <numbers>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr int n_iterations_assumed = 4, n_factorisations_assumed = 1;
constexpr double steps_per_period = 20;
constexpr int n_substeps_measured = 20, n_repetitions = 3;

double seconds_of(const ImplicitCost& cost) {
  return n_iterations_assumed * cost.iteration_seconds + n_factorisations_assumed * cost.factorisation_seconds;
}

}  // namespace

double seconds_of_substep(SolidModel& model, double step) {
  using Clock = std::chrono::steady_clock;
  const int n = std::min(model.n_substeps(step), n_substeps_measured);
  const double duration = step / model.n_substeps(step) * n;
  const auto load = surface::NodeArray::Zero(static_cast<Eigen::Index>(model.wetted().solid_node.size()), 3);
  double fastest = std::numeric_limits<double>::max();
  for (int k = 0; k < n_repetitions; ++k) {
    const auto began = Clock::now();
    model.solve_step(duration, load);
    fastest = std::min(fastest, std::chrono::duration<double>(Clock::now() - began).count() / n);
  }
  return fastest;
}

double seconds_of_implicit_substep(SolidModel& model, double step) {
  return seconds_of(model.implicit_cost(step));
}

TimeMethodChoice choose_time_method(SolidSetup setup, double step) {
  TimeMethodChoice choice;
  setup.method = TimeMethod::central_difference;
  SolidModel by_substeps(setup);
  const int n_substeps = by_substeps.n_substeps(step);
  choice.seconds_explicit = n_substeps * seconds_of_substep(by_substeps, step);
  setup.method = TimeMethod::generalized_alpha;
  ImplicitCost cost;
  try {
    SolidModel by_iterations(std::move(setup));
    const int n_implicit = by_iterations.n_substeps(step);
    if (const double least = n_implicit * by_iterations.least_factorisation_seconds();
        least > choice.seconds_explicit) {  // not worth a try, which would take as long
      choice.reason = "CENTRAL_DIFFERENCE, because a step takes about " + report::text(choice.seconds_explicit) +
                      " s with " + std::to_string(n_substeps) +
                      " explicit substeps and a single factorisation at least " + report::text(least) + " s";
      return choice;
    }
    cost = by_iterations.implicit_cost(step);
    choice.seconds_implicit = n_implicit * seconds_of(cost);
  } catch (const report::NumericsError& failure) {
    choice.reason = "CENTRAL_DIFFERENCE, because of an implicit step " + failure.sentence();
    return choice;
  }

  const double period = 2 * std::numbers::pi / cost.lowest_rate;
  const bool is_resolved = step * steps_per_period <= period,
             is_cheaper = choice.seconds_implicit < choice.seconds_explicit;
  using report::text;
  const std::string seconds = "a step takes about " + text(choice.seconds_explicit) + " s with " +
                              std::to_string(n_substeps) + " explicit substeps and " + text(choice.seconds_implicit) +
                              " s implicitly";
  if (is_cheaper && is_resolved) {
    choice.method = TimeMethod::generalized_alpha;
    choice.reason = "GENERALIZED_ALPHA, because " + seconds;
  } else if (is_cheaper) {
    choice.reason = "CENTRAL_DIFFERENCE, because the step of " + text(step) +
                    " s is more than a twentieth of the slowest period, " + text(period) + " s, although " + seconds;
  } else {
    choice.reason = "CENTRAL_DIFFERENCE, because " + seconds;
  }
  return choice;
}

}  // namespace couplet::solid
