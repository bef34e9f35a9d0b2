#pragma once
// Meshes from the input files of Abaqus and CalculiX.

#include <string>
#include <string_view>

#include "solid-server/mesh/file/mesh_reading.hpp"

namespace couplet::solid {

/// Elements C3D20, C3D20R, C3D8, C3D8R, C3D8I and C3D10. An element's region is the ELSET of its *ELEMENT. The sets of
/// *ELSET become regions instead where they hold every element once; sets of all elements, internal sets and sets that
/// make a *SURFACE do not count. Elements of surfaces (S, CPS, CPE, M3D, as Gmsh writes them) make surfaces named by
/// their sets; elements of lines are passed over. *SURFACE of type ELEMENT are surfaces, of type NODE node sets, like
/// *NSET (a marker where it is one node). Keywords and names mean the same in capitals and small letters; names are
/// given on as they are first written. Lengths are multiplied by `length_unit` [m]. Materials, steps and other keywords
/// are skipped; the note says which.
///
/// Node orders of these elements are those of ElementShape. Their sides: hexahedra S1 zeta = -1, S2 zeta = +1, S3 eta =
/// -1, S4 xi = +1, S5 eta = +1, S6 xi = -1; tetrahedra S1 to S4 are faces 0 to 3 [CalculiX CrunchiX user's manual,
/// chapter on elements].
///
/// The mesh is not checked: see check_mesh. Throws SceneError with file and line for what cannot be understood, for
/// other elements, and for keywords that would make nodes or elements in another way (*INCLUDE, *NGEN, several
/// instances).
MeshReading read_abaqus(std::string_view text, const std::string& file, double length_unit);

}  // namespace couplet::solid
