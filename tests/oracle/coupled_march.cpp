#include "tests/oracle/coupled_march.hpp"

#include <algorithm>

#include "coupler/scheme/interface_pair.hpp"
#include "coupler/scheme/make_scheme.hpp"

namespace couplet::oracle {

double CoupledMarch::iterations_mean() const {
  double sum = 0;
  for (const auto& step : steps) sum += step.iterations;
  return sum / static_cast<double>(steps.size());
}

int CoupledMarch::iterations_max() const {
  int largest = 0;
  for (const auto& step : steps) largest = std::max(largest, step.iterations);
  return largest;
}

CoupledMarch march(participant::Participant& flow, participant::Participant& solid, const v1::Coupling& coupling,
                   double end, double step) {
  const participant::Opened solid_opened = solid.open({});
  participant::OpenRequest flow_request;
  flow_request.peer_surface = solid_opened.surface;
  const participant::Opened flow_opened = flow.open(flow_request);
  coupling::InterfacePair pair(flow, solid, flow_opened, solid_opened, coupling::make_mapping_kind(coupling.mapping()));
  coupling::ConvergenceHistory history = coupling::make_convergence_history(coupling, pair.layout());
  CoupledMarch march;
  coupling::TimeLoop loop(flow, solid, coupling::make_scheme(coupling, pair, history, solid_opened.time),
                          coupling::StepSize(end, step, coupling.halvings_max()), coupling.iterations_max(),
                          [&march](const std::string&) { ++march.n_discarded; });
  while (!loop.is_at_end()) march.steps.push_back(loop.advance());
  return march;
}

}  // namespace couplet::oracle
