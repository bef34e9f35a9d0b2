#pragma once
// Surfaces that other programs made.

#include <filesystem>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// Reads an STL (text or binary), OBJ or PLY file, told by its ending. Lengths are taken as metres times `scale`.
/// Corners at exactly the same place become one node (an STL repeats them), polygons become triangles, triangles with
/// two equal corners are left out. All objects of the file make one surface. Throws FileError by the name of the file.
surface::SurfaceMesh read_surface_file(const std::filesystem::path& file, double scale = 1);

}  // namespace couplet::flow
