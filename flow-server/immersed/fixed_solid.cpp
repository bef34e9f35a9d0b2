#include "flow-server/immersed/fixed_solid.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "flow-server/immersed/cut_cells.hpp"

namespace couplet::flow {

namespace {

/// Cells around cut ones that stay: the velocities of faces one cell behind a wall are set to the wall's own, and the
/// pressure is carried over two.
constexpr int reach = 2;

std::vector<BodySurface> fixed_ones(std::span<const BodySurface> surfaces) {
  const bool has_moving_lumen = std::any_of(surfaces.begin(), surfaces.end(), [](const BodySurface& surface) {
    return surface.is_lumen && !surface.is_fixed;
  });
  std::vector<BodySurface> fixed;
  for (const BodySurface& surface : surfaces)
    if (surface.is_closed && surface.is_fixed && !(surface.is_lumen && has_moving_lumen)) fixed.push_back(surface);
  return fixed;
}

}  // namespace

FixedSolid::FixedSolid(const StretchedGrid& grid, const BlockDecomposition& decomposition,
                       std::span<const BodySurface> surfaces)
    : grid_(&grid), origin_(decomposition.mine().begin) {
  const std::vector<BodySurface> fixed = fixed_ones(surfaces);
  if (fixed.empty() || !decomposition.has_cells()) return;
  EdgeCrossings crossings(grid, decomposition.mine(), reach + 1);
  crossings.update(fixed);
  CutCells cut(grid, crossings);
  cut.update(fixed);
  const bool is_flat = grid.n_dimensions == 2;
  const Triple sizes = decomposition.mine().sizes(), layer{1, 1, is_flat ? 0 : 1};
  const Box around = box_of(sizes).grown(layer);
  Field<std::uint8_t> is_reached(sizes, layer);
  const int depth = is_flat ? 0 : reach;
  for (const CutCell& cell : cut.cells()) {
    const Box near =
        intersection(around, {{cell.cell[0] - reach, cell.cell[1] - reach, cell.cell[2] - depth},
                              {cell.cell[0] + reach + 1, cell.cell[1] + reach + 1, cell.cell[2] + depth + 1}});
    for (int k = near.begin[2]; k < near.end[2]; ++k)
      for (int j = near.begin[1]; j < near.end[1]; ++j)
        for (int i = near.begin[0]; i < near.end[0]; ++i) is_reached(i, j, k) = 1;
  }
  cells_ = ActiveCells::where(around, [&](int i, int j, int k) {
    return cut.is_solid({i, j, k}) && is_reached(i, j, k) == 0;
  });
}

bool FixedSolid::contains(const Point& centre) const {
  if (is_empty()) return false;
  Triple cell;
  for (int d = 0; d < 3; ++d) {
    const std::vector<double>& faces = grid_->axis[d].faces();
    const auto next = std::upper_bound(faces.begin(), faces.end(), centre[static_cast<std::size_t>(d)]);
    cell[d] = static_cast<int>(next - faces.begin()) - 1 - origin_[d];
  }
  return contains(cell);
}

}  // namespace couplet::flow
