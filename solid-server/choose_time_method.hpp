#pragma once
// Explicit or implicit: what a step costs either way.

#include "solid-server/solid_model.hpp"

namespace couplet::solid {

struct TimeMethodChoice {
  TimeMethod method = TimeMethod::central_difference;
  double seconds_explicit = 0, seconds_implicit = 0;  // a coupling step, estimated [s]
  std::string reason;                                 // one sentence
};

/// Measures the body at rest: a substep of the central difference method times their number; against four iterations
/// and one factorisation of a generalized-alpha step, which is what large steps of moving bodies take and more than
/// small ones do. Implicit steps are taken only when they cost less and resolve the slowest motion of the body with at
/// least 20 steps a period: faster modes are then damped by the spectral radius, not followed. A body that is free as a
/// whole counts as slow.
///
/// A step that cannot be taken implicitly, because there is no memory for its factors, say, is taken explicitly.
///
/// Clocks decide, so two runs may differ; a run keeps its choice in its checkpoints.
TimeMethodChoice choose_time_method(SolidSetup setup, double step);

/// Measured on the accepted state of an explicit model, which stays as it is [s].
double seconds_of_substep(SolidModel& model, double step);

/// Of a substep by Newton's method, as assumed above, from a factorisation and an iteration at the accepted state [s].
double seconds_of_implicit_substep(SolidModel& model, double step);

}  // namespace couplet::solid
