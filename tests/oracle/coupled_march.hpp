#pragma once
// A coupled run in this process without files.

#include <vector>

#include "coupler/scheme/time_loop.hpp"
#include "couplet/v1/coupling.pb.h"

namespace couplet::oracle {

struct CoupledMarch {
  std::vector<coupling::AcceptedStep> steps;
  int n_discarded = 0;  // attempts that were thrown away

  double iterations_mean() const;
  int iterations_max() const;
};

/// From the state in which both open to `end`. Throws what a run throws.
CoupledMarch march(participant::Participant& flow, participant::Participant& solid, const v1::Coupling& coupling,
                   double end, double step);

}  // namespace couplet::oracle
