#pragma once
// How the forces of a follower pressure change with the displacements.

#include <functional>

#include "solid-server/element/face_packs.hpp"

namespace couplet::solid {

/// Takes C_ab = - d f_a / d u_b [N/m] for a pair of nodes of the mesh.
using TakeStiffness = std::function<void(Index node_a, Index node_b, const Eigen::Matrix3d& block)>;

/// Of the forces of surface_pressure.hpp:
///   C_ab = p sum over points of N_a (dN_b/deta [x,xi] - dN_b/dxi [x,eta]) w,   [v] d = v x d,
/// for every pair of nodes of a face. Its sum over the faces of a smooth surface is symmetric except for what stands on
/// the rim of the surface, and wholly so where the rim is held [Bonet, Wood 2008, 8.5]. A method that takes the
/// symmetric part changes its rate of convergence, not its result; statics with a free rim hardly converge without the
/// other part (assembly/skew_part.hpp). `displacement`: (n_nodes, 4) [m].
void pressure_stiffness(const FacePacks& faces, double pressure, const NodeVectors& displacement,
                        const TakeStiffness& take);

}  // namespace couplet::solid
