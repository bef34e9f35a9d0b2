#pragma once
// How an element turns displacements into strains, and which choice suits which element and law.

#include <string>

#include "solid-server/material/material.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

enum class ElementFormulation {
  standard,             // F from the displacements at every point
  near_incompressible,  // the volume ratio J is replaced by its projection (volume_projection.hpp)
  stabilised,           // 8-node hexahedra: mean F, bending and twisting by stabilisation (stabilisation.hpp)
};

/// hexahedron8 stabilised, the others standard.
ElementFormulation default_formulation(ElementShape shape);

/// Quadrature points when nobody asks for a number: tetrahedron10 4; hexahedron8 1 if stabilised, else 8; hexahedron20
/// 8, which bend best, but 27 where edges are curved and 14 where elements stand in single rows.
int default_n_points(const SolidMesh& mesh, const ElementBlock& block, ElementFormulation formulation);

/// Whether the midside node of an edge lies off its middle by more than 5 % of the edge's length. Only 27 points pass
/// the patch test on curved edges; up to this limit the forces of 8 points are wrong by 4e-5 of the pressure-wave
/// modulus times an element's area in the patch test, and 27 points would bend worse.
bool has_curved_edges(const SolidMesh& mesh, const ElementBlock& block);

/// Whether a hexahedron has neighbours in one of its three directions only, or in none. With 8 points such elements
/// have modes without energy that a whole row can follow, u = (0, y (z^2 - 1/3), - z (y^2 - 1/3)) in a row along x: its
/// tangent is singular. Two elements across do not have them.
bool has_single_rows(const SolidMesh& mesh, const ElementBlock& block);

/// Throws SceneError, naming `where`, when the formulation does not exist for the shape (near_incompressible:
/// hexahedron20 and tetrahedron10; stabilised: hexahedron8) or needs W = W_1(F) + U(J) and the law has no such parts.
void check_formulation(const std::string& where, ElementShape shape, ElementFormulation formulation,
                       const Material& material);

}  // namespace couplet::solid
