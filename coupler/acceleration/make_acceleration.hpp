#pragma once
// From the scene to an acceleration.

#include <memory>

#include "coupler/acceleration/acceleration.hpp"
#include "couplet/v1/coupling.pb.h"

namespace couplet::coupling {

/// `constant_factor` (n_total) is used when the scene asks for constant relaxation. Without any choice: IQN-ILS.
std::unique_ptr<Acceleration> make_acceleration(const v1::Coupling& coupling, InterfaceSize size,
                                                const Eigen::VectorXd& constant_factor);

}  // namespace couplet::coupling
