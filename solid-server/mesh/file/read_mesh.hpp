#pragma once
// Mesh files of any format that is read.

#include <filesystem>

#include "solid-server/mesh/file/mesh_reading.hpp"

namespace couplet::solid {

/// Reads a mesh by the ending of its name, .msh (see read_gmsh) or .inp (see read_abaqus), and checks it (see
/// check_mesh). Lengths are multiplied by `length_unit` [m]. Throws FileError when the file cannot be read, SceneError
/// when it is wrong.
MeshReading read_mesh(const std::filesystem::path& file, double length_unit);

}  // namespace couplet::solid
