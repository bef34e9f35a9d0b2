#pragma once
// How well an element is shaped.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// The smallest scaled Jacobian at a corner of the element: det(dX/dxi) over the product of the lengths of its columns,
/// for a tetrahedron times sqrt(2), so that 1 is a cube or a regular tetrahedron and 0 flat; negative: folded. Linear
/// in no size [Knupp 2003, Algebraic mesh quality metrics].
double scaled_jacobian(const SolidMesh& mesh, Index element);

/// The smallest over all elements.
double smallest_scaled_jacobian(const SolidMesh& mesh);

}  // namespace couplet::solid
