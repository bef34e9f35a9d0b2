#include "flow-server/momentum/flow_block.hpp"

#include <algorithm>

namespace couplet::flow {

AxisMetrics make_axis_metrics(const StretchedAxis& axis, int begin, int end) {
  const int n = end - begin;
  AxisMetrics metrics{AxisValues(n), AxisValues(n), AxisValues(n), AxisValues(n),
                      AxisValues(n), AxisValues(n), AxisValues(n)};
  const auto width = [&](int cell) {
    return axis.is_periodic() || (cell >= 0 && cell < axis.n_cells()) ? axis.width(cell) : 0.0;
  };
  for (int i = -axis_margin; i < n + axis_margin; ++i) {
    const int cell = begin + i;
    const double here = width(cell), next = width(cell + 1);
    metrics.centre[i] = axis.centre(cell);
    metrics.face[i] = axis.face(cell + 1);
    metrics.width[i] = here;
    metrics.inverse_width[i] = here > 0 ? 1 / here : 0;
    metrics.inverse_control_width[i] = here + next > 0 ? 2 / (here + next) : 0;
    metrics.inverse_distance[i] = 1 / axis.distance(cell);
    metrics.share[i] = here + next > 0 ? here / (here + next) : 0;
  }
  return metrics;
}

Point centre_of_cell(const FlowBlock& block, const Triple& cell) {
  const Triple& origin = block.decomposition->mine().begin;
  Point point;
  for (int e = 0; e < 3; ++e) point[e] = block.grid->axis[e].centre(origin[e] + cell[e]);
  return point;
}

Point centre_of_face(const FlowBlock& block, int d, const Triple& cell) {
  Point point = centre_of_cell(block, cell);
  point[d] = block.grid->axis[d].face(block.decomposition->mine().begin[d] + cell[d] + 1);
  return point;
}

void set_zero(const FlowBlock& block, Field<double>& field) {
  for (int k = 0; k < block.sizes[2]; ++k)
    for (int j = 0; j < block.sizes[1]; ++j)
      for_each_interval(block.cells, j, k, 0, block.sizes[0],
                        [&](int begin, int end) { std::fill(field.row(j, k) + begin, field.row(j, k) + end, 0.0); });
}

}  // namespace couplet::flow
