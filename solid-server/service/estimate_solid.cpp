#include "solid-server/service/estimate_solid.hpp"

#include <chrono>
#include <cmath>

#include "solid-server/choose_time_method.hpp"
#include "solid-server/service/make_setup.hpp"

namespace couplet::solid {

namespace {

/// Repeats the first step for a moment; the accepted state stays as it is.
double seconds_per_substep(SolidModel& model, double duration) {
  using Clock = std::chrono::steady_clock;
  const auto load = surface::NodeArray::Zero(static_cast<Eigen::Index>(model.wetted().solid_node.size()), 3);
  const auto seconds_of = [&] {
    const auto started = Clock::now();
    model.solve_step(duration, load);
    return std::chrono::duration<double>(Clock::now() - started).count() /
           static_cast<double>(model.work_of_last_step().n_substeps);
  };
  double fastest = seconds_of();
  const auto end = Clock::now() + std::chrono::milliseconds(200);
  while (Clock::now() < end) fastest = std::min(fastest, seconds_of());
  return fastest;
}

}  // namespace

std::vector<participant::NamedNumber> estimate_solid(const participant::OpenRequest& request, int threads) {
  SolidSetup setup = make_setup(request.scene.solid(), request.scene_folder);
  setup.n_threads = worthwhile_threads(threads, setup.mesh.n_elements());
  const int n_threads = setup.n_threads;
  const double step = request.scene.time().step(), n_steps = std::ceil(request.scene.time().end() / step);
  const auto method = request.scene.solid().time_integration().method();
  TimeMethodChoice choice;
  if (method == v1::TimeIntegration::AUTO || method == v1::TimeIntegration::GENERALIZED_ALPHA) {
    choice = choose_time_method(setup, step);
    if (method == v1::TimeIntegration::AUTO) setup.method = choice.method;
  }
  SolidModel model(std::move(setup));
  std::vector<participant::NamedNumber> numbers = {
      {"elements", static_cast<double>(model.mesh().n_elements()), "1"},
      {"nodes", static_cast<double>(model.mesh().n_nodes()), "1"},
      {"degrees_of_freedom", 3.0 * model.mesh().n_nodes(), "1"},
      {"interface_nodes", static_cast<double>(model.wetted().solid_node.size()), "1"},
      {"memory_bytes", static_cast<double>(model.memory_bytes()), "1"},
      {"threads", static_cast<double>(n_threads), "1"}};
  if (choice.seconds_implicit > 0) {
    numbers.push_back({"seconds_per_explicit_step", choice.seconds_explicit, "s"});
    numbers.push_back({"seconds_per_implicit_step", choice.seconds_implicit, "s"});
  }
  const int n_substeps = model.n_substeps(step);
  numbers.push_back({"substeps_per_step", static_cast<double>(n_substeps), "1"});
  double seconds_per_step = choice.seconds_implicit;
  if (model.accepted().method == TimeMethod::central_difference) {
    const double seconds = seconds_per_substep(model, step);
    numbers.push_back({"stable_step", model.accepted().stable_step, "s"});
    numbers.push_back({"seconds_per_substep", seconds, "s"});
    seconds_per_step = seconds * n_substeps;
  } else if (model.accepted().method == TimeMethod::static_equilibrium) {
    seconds_per_step = seconds_per_substep(model, step);
  }
  numbers.push_back({"seconds", seconds_per_step * n_steps, "s"});
  return numbers;
}

}  // namespace couplet::solid
