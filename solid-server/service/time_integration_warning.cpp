#include "solid-server/service/time_integration_warning.hpp"

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr double n_steps_harmless = 200;  // growth was seen after some hundred steps

}  // namespace

std::string time_integration_warning(const v1::Scene& scene, TimeMethod method) {
  const double n_steps = scene.time().end() / scene.time().step();
  if (method != TimeMethod::generalized_alpha || scene.solid().time_integration().spectral_radius() < 1 ||
      n_steps <= n_steps_harmless)
    return {};
  return "solid.time_integration.spectral_radius: 1 damps nothing; over the " + report::text(n_steps) +
         " steps of this run, motions that a step does not resolve may grow until it fails; 0.95 damps them and little "
         "else";
}

}  // namespace couplet::solid
