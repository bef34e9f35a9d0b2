#pragma once
// Linear systems that differ little from one that can be solved.

#include <functional>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

using LinearMap = std::function<NodeVectors(const NodeVectors&)>;

/// x with A x = b by the generalised minimal residual method [Saad, Schultz 1986] on P^-1 A x = P^-1 b. Ends when
/// |P^-1 (b - A x)| <= tolerance |P^-1 b|, or after n_most products with A: x is the best one so far.
NodeVectors minimal_residual(const LinearMap& multiply, const LinearMap& solve_nearby, const NodeVectors& b,
                             double tolerance, int n_most);

}  // namespace couplet::solid
