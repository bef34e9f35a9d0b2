#pragma once
// A stretched Cartesian block in two or three dimensions.

#include <array>

#include "flow-server/grid/box.hpp"
#include "flow-server/grid/stretched_axis.hpp"

namespace couplet::flow {

/// In two dimensions the third axis has one cell, which gives areas and volumes their depth and nothing else: no
/// velocity along it, no ghost layers, no terms.
struct StretchedGrid {
  std::array<StretchedAxis, 3> axis;
  int n_dimensions = 3;

  Triple n_cells() const { return {axis[0].n_cells(), axis[1].n_cells(), axis[2].n_cells()}; }
  std::array<bool, 3> is_periodic() const {
    return {axis[0].is_periodic(), axis[1].is_periodic(), n_dimensions == 3 && axis[2].is_periodic()};
  }
  double volume(const Triple& cell) const {
    return axis[0].width(cell[0]) * axis[1].width(cell[1]) * axis[2].width(cell[2]);
  }
};

}  // namespace couplet::flow
