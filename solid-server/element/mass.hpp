#pragma once
// Lumped mass.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// HRZ lumping [Hinton, Rock, Zienkiewicz 1976]: the diagonal of the consistent element mass, scaled so that the
/// element keeps its mass. Always positive; a cube gives 0.0282 of its mass to a corner and 0.0645 to a midside node.
/// (n_nodes) [kg]
Eigen::VectorXd lumped_mass(const SolidMesh& mesh, double density);

}  // namespace couplet::solid
