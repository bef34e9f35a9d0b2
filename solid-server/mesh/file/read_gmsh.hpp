#pragma once
// Meshes from Gmsh: text .msh files of version 4.1 and 2.2.

#include <string>
#include <string_view>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Hexahedra with 20 or 8 nodes and tetrahedra with 10. Physical volumes are regions, physical surfaces are surfaces,
/// physical curves and points are node sets (a marker where it is one node); a group without a name is called by its
/// number. Element data named "fibre" (3 numbers an element) are the first material axis, "cross_fibre" the second.
/// Lengths are multiplied by `length_unit` [m]. Other sections are skipped.
///
/// The mesh is not checked: see check_mesh. Throws SceneError with file and line for what cannot be understood: binary
/// files, other versions, other solid elements, wrong numbers, a file that is cut off. The formats are those of the
/// Gmsh reference manual [Geuzaine, Remacle 2009].
SolidMesh read_gmsh(std::string_view text, const std::string& file, double length_unit);

}  // namespace couplet::solid
