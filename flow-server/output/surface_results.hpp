#pragma once
// What is stored of the surfaces of bodies, for ParaView.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "flow-server/immersed/body_loads.hpp"
#include "flow-server/output/flow_measurement.hpp"
#include "flow-server/output/parallel_file.hpp"

namespace couplet::flow {

/// What never changes of a stored surface: the first corners and triangles of the surface of a body.
struct StoredSurface {
  std::string name;  // of the body
  bool has_two_sides = false;
  std::int64_t n_corners = 0;
  std::vector<std::array<int, 3>> triangle;
};

StoredSurface stored_surface(const BodySurface& shown);

/// A field of the corners of a surface.
struct SurfaceField {
  std::string name;
  int n_components = 1;
};
/// position [m], velocity [m/s], force [N] of the fluid, pressure [Pa] in the fluid - of a sheet pressure_outer, on the
/// side that the normals of the triangles point to, and pressure_inner - and viscous_traction [Pa].
std::vector<SurfaceField> fields_of(const StoredSurface& surface);

/// The fields of a surface at one time, in the order of fields_of(), each (n_corners * n_components).
using SurfaceValues = std::vector<std::vector<double>>;

/// Collective; the same on all ranks. `loads`: on all corners of the surfaces in the flow; `force`: of these on the
/// corners that are stored [N]. Pressure and viscous traction of a
/// corner are means over the walls in cut cells that it moves, with the weights with which it does: they do not depend
/// on how large its triangles are. Corners between which and the fluid there is none - triangles far smaller than
/// cells, those inside other bodies or beyond the grid - take the mean of the neighbours that have a value.
std::vector<SurfaceValues> measure_surfaces(const FlowPart& part, std::span<const StoredSurface> surfaces,
                                            std::span<const SurfaceLoad> loads,
                                            std::span<const std::vector<Point>> force);

/// Into the file of a state, as body/NAME/FIELD, (n_corners) or (n_corners, 3), in single precision.
void write_surface(ParallelFile& file, const StoredSurface& surface, const SurfaceValues& values, int rank);

}  // namespace couplet::flow
