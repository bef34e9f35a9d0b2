#pragma once
// The largest stable step of the central difference method.

#include <functional>

#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// 2 / omega_max (sqrt(1 + zeta^2) - zeta) [s], zeta = beta omega_max / 2 (damping by stiffness), where omega_max^2 is
/// the largest eigenvalue of M^-1 K, K = - d(internal force)/du at `displacement`. A Lanczos iteration on M^-1/2 K
/// M^-1/2 from a fixed start vector, with K applied as a difference of two forces [Golub, Van Loan 2013, 10.1]; the
/// eigenvalue returned is the Ritz value plus its residual, so that the step errs on the small side.
/// `extra_rate_squared` [1/s^2] is added to the eigenvalue (a bound for contact). `internal_force` writes the force at
/// given displacements to its second argument (n_nodes, 4) [N]. Same input, same bits, whatever the size of the team.
double stable_step(const std::function<void(const NodeVectors&, NodeVectors&)>& internal_force,
                   const NodeVectors& displacement, const NodeVectors& inverse_mass, double smallest_length,
                   double extra_rate_squared, WorkTeam& team, double stiffness_damping = 0);

}  // namespace couplet::solid
