#include "flow-server/output/field_region.hpp"

#include <algorithm>

namespace couplet::flow {

std::string name_of(FieldQuantity quantity) {
  switch (quantity) {
    case FieldQuantity::velocity:
      return "velocity";
    case FieldQuantity::pressure:
      return "pressure";
    case FieldQuantity::vorticity:
      return "vorticity";
    case FieldQuantity::q_criterion:
      return "q_criterion";
    case FieldQuantity::swirling_strength:
      return "swirling_strength";
    case FieldQuantity::fluid_share:
      return "fluid_share";
  }
  return "unknown";
}

bool is_vector(FieldQuantity quantity) {
  return quantity == FieldQuantity::velocity || quantity == FieldQuantity::vorticity;
}

int n_picture_cells(const FieldRegion& region, int d) {
  return (region.cells.size(d) + region.stride - 1) / region.stride;
}

int shown_cell(const FieldRegion& region, int d, int m) {
  const int begin = region.cells.begin[d] + m * region.stride;
  const int end = std::min(begin + region.stride, region.cells.end[d]);
  return begin + (end - begin - 1) / 2;
}

std::vector<double> picture_faces(const FieldRegion& region, const StretchedGrid& grid, int d) {
  const StretchedAxis& axis = grid.axis[d];
  std::vector<double> faces;
  for (int m = 0; m < n_picture_cells(region, d); ++m)
    faces.push_back(axis.face(region.cells.begin[d] + m * region.stride));
  faces.push_back(axis.face(region.cells.end[d]));
  return faces;
}

}  // namespace couplet::flow
