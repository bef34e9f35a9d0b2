#pragma once
// Whether a mode is its own mirror image.

#include <optional>

#include "solid-server/modal/modal_analysis.hpp"

namespace couplet::solid {

/// The plane X_axis = place.
struct MirrorPlane {
  int axis = 0;      // 0, 1, 2 for x, y, z
  double place = 0;  // [m]
};

/// The plane through the middle of a mesh, across an axis.
MirrorPlane middle_plane(const SolidMesh& mesh, int axis);

/// The node at the mirror image of each node, (n_nodes); nothing when a node has none.
std::optional<std::vector<Index>> mirrored_nodes(const SolidMesh& mesh, const MirrorPlane& plane);

enum class Symmetry { symmetric, antisymmetric, neither };

/// Symmetric: equal to its mirror image; antisymmetric: to minus that. By the correlation phi^T M (image of phi), which
/// is 1 or -1 then; modes of one frequency may mix to neither.
Symmetry symmetry_of(const TangentSolver& solver, const Mode& mode, const MirrorPlane& plane,
                     const std::vector<Index>& mirrored);

}  // namespace couplet::solid
