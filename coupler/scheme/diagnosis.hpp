#pragma once
// Why a step does not converge, in plain words.

#include <string>

#include "coupler/convergence/convergence_history.hpp"

namespace couplet::coupling {

/// The last changes of each field against their limits, how they developed, and the estimated added-mass number.
std::string describe_attempt(const ConvergenceHistory& history, double added_mass_number);

/// What to change in the scene.
std::string advise(const ConvergenceHistory& history, double added_mass_number, int iterations_max);

}  // namespace couplet::coupling
