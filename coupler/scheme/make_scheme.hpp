#pragma once
// From the scene to a scheme.

#include <memory>
#include <vector>

#include "coupler/convergence/convergence_history.hpp"
#include "coupler/mapping/mapping.hpp"
#include "coupler/scheme/interface_pair.hpp"
#include "coupler/scheme/step_scheme.hpp"
#include "couplet/v1/coupling.pb.h"

namespace couplet::coupling {

MappingKind make_mapping_kind(v1::Mapping mapping);

/// The criteria of the scene with their units; for the explicit scheme none, the motion fields instead: how far each
/// was from its prediction. Throws SceneError when a criterion names a field that is not exchanged.
ConvergenceHistory make_convergence_history(const v1::Coupling& coupling, const InterfaceLayout& layout);

/// `pair` and `history` must outlive it.
std::unique_ptr<StepScheme> make_scheme(const v1::Coupling& coupling, InterfacePair& pair, ConvergenceHistory& history,
                                        double start_time);

}  // namespace couplet::coupling
