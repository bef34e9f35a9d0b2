#pragma once
// The cells, the moving faces and the widths of one rank, ready for kernels.

#include <array>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"
#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"

namespace couplet::flow {

/// Numbers along an axis are known that many cells beyond a block.
inline constexpr int axis_margin = 4;

/// One number for each cell or face of a direction of a block and of its margin.
class AxisValues {
 public:
  explicit AxisValues(int n_cells = 0) : values_(static_cast<std::size_t>(n_cells + 2 * axis_margin)) {}
  double& operator[](int i) { return values_[static_cast<std::size_t>(i + axis_margin)]; }
  double operator[](int i) const { return values_[static_cast<std::size_t>(i + axis_margin)]; }
  const double* from_zero() const { return values_.data() + axis_margin; }

 private:
  std::vector<double> values_;
};

/// Widths along one direction. A cell beyond a border of the grid has no width in what concerns the velocity normal to
/// it, so that the control volume of a face of the border is half a cell; tangential velocities see a mirrored cell.
struct AxisMetrics {
  AxisValues centre, face;           // of cell i; face i between cells i and i + 1 [m]
  AxisValues width;                  // of cell i, 0 beyond a border [m]
  AxisValues inverse_width;          // 0 beyond a border [1/m]
  AxisValues inverse_control_width;  // 1 / (half of cells i and i + 1) [1/m]
  AxisValues inverse_distance;       // 1 / (from centre i to centre i + 1), with mirrored cells beyond borders [1/m]
  AxisValues share;                  // width(i) / (width(i) + width(i + 1))
};

/// A face with a tangential wall along cell faces inside the grid, where fluid ends: the velocity beyond is 0 in
/// memory, but the wall stands half a cell nearer. What the shear lacks is viscosity * coefficient * velocity.
struct InnerWall {
  Triple cell;
  int direction;       // normal to the wall
  double coefficient;  // [1/m^2]
};

struct FlowBlock {
  const StretchedGrid* grid = nullptr;
  const BlockDecomposition* decomposition = nullptr;
  int n_dimensions = 3;
  Triple sizes{};   // cells of this rank
  Triple ghosts{};  // two layers in the directions of the flow
  std::array<AxisMetrics, 3> axis;
  ActiveCells cells = ActiveCells::all({});  // fluid, of this rank
  /// Faces whose velocity is unknown: fluid on both sides, or an opening of the border. Those at the start of the block
  /// (-1) are listed too, whoever owns them.
  std::array<ActiveCells, 3> faces{ActiveCells::all({}), ActiveCells::all({}), ActiveCells::all({})};
  std::array<std::vector<InnerWall>, 3> inner_walls;  // of each component

  /// Faces of direction d that this rank computes: those at its start only on the border of the grid.
  Box computed_faces(int d) const {
    Box box = box_of(sizes);
    if (decomposition->is_at_border(d, 0)) box.begin[d] = -1;
    return box;
  }
  /// The cells and the faces around them.
  Box everything() const { return box_of(sizes).grown({1, 1, 1}); }
  Field<double> new_field() const { return {sizes, ghosts}; }
  VectorField new_vector_field() const {
    VectorField fields;
    for (int d = 0; d < n_dimensions; ++d) fields[static_cast<std::size_t>(d)] = new_field();
    return fields;
  }
};

/// Where the middle of a cell, and of its face at the end of direction d, stand [m]; local indices.
Point centre_of_cell(const FlowBlock& block, const Triple& cell);
Point centre_of_face(const FlowBlock& block, int d, const Triple& cell);

/// The metrics of the part begin <= i < end of an axis.
AxisMetrics make_axis_metrics(const StretchedAxis& axis, int begin, int end);

/// The intervals of a row inside begin <= i < end.
template <class Visit>
void for_each_interval(const ActiveCells& cells, int j, int k, int begin, int end, const Visit& visit) {
  const Box& range = cells.range();
  if (j < range.begin[1] || j >= range.end[1] || k < range.begin[2] || k >= range.end[2]) return;
  for (const Interval& interval : cells.row(j, k)) {
    const int from = interval.begin > begin ? interval.begin : begin;
    const int to = interval.end < end ? interval.end : end;
    if (from < to) visit(from, to);
  }
}

/// Makes the values of the cells that hold fluid 0; the others are never touched.
void set_zero(const FlowBlock& block, Field<double>& field);

}  // namespace couplet::flow
