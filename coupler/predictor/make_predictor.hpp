#pragma once
// From the scene to a predictor.

#include <memory>

#include "coupler/predictor/predictor.hpp"
#include "couplet/v1/coupling.pb.h"

namespace couplet::coupling {

/// `n_primary` leading entries of the state decide. An explicit scheme never gets the fitted predictor: there the
/// prediction is not corrected within the step, and a fit that chases its own errors could drive them.
std::unique_ptr<Predictor> make_predictor(const v1::Coupling& coupling, Eigen::Index n_primary);

}  // namespace couplet::coupling
