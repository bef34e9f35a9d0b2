#pragma once
// A part of the grid that is stored, and the coarser picture that stands for it.

#include <string>
#include <vector>

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/output/parallel_file.hpp"

namespace couplet::flow {

/// fluid_share: of the cell's volume, 0 inside bodies and solid cells.
enum class FieldQuantity { velocity, pressure, vorticity, q_criterion, swirling_strength, fluid_share };

std::string name_of(FieldQuantity quantity);
bool is_vector(FieldQuantity quantity);

/// A part of the grid that is stored. With a stride the cells of the picture are as many cells wide, and hold the
/// values of the cell in their middle.
struct FieldRegion {
  std::string name;
  Box cells;  // in indices of the whole
  int stride = 1;
  std::vector<FieldQuantity> quantities;
  Precision precision = Precision::single;
};

/// Cells of the picture of a region along a direction.
int n_picture_cells(const FieldRegion& region, int d);

/// The cell of the grid whose value picture cell m shows.
int shown_cell(const FieldRegion& region, int d, int m);

/// Where the cells of the picture meet along a direction [m].
std::vector<double> picture_faces(const FieldRegion& region, const StretchedGrid& grid, int d);

}  // namespace couplet::flow
