#pragma once
// Lumped mass.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// HRZ lumping [Hinton, Rock, Zienkiewicz 1976]: the diagonal of the consistent element mass, scaled so that the
/// element keeps its mass. Always positive; a cube of 20 nodes gives 0.0282 of its mass to a corner and 0.0645 to a
/// midside node. `density` of each block at rest [kg/m^3]; (n_nodes) [kg].
Eigen::VectorXd lumped_mass(const SolidMesh& mesh, const std::vector<double>& density);

/// The row sums of the consistent mass, integral of rho N_a: what a uniform acceleration acts on. Not always positive.
Eigen::VectorXd row_sums_of_mass(const SolidMesh& mesh, const std::vector<double>& density);

}  // namespace couplet::solid
