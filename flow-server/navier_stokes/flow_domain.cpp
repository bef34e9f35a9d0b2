#include "flow-server/navier_stokes/flow_domain.hpp"

#include "flow-server/grid/halo_exchange.hpp"

namespace couplet::flow {

namespace {

/// Faces with unknown velocity next to one, across, that is closed; but for those on the border of the grid, beside
/// which the velocity is that of the border's patches.
void find_inner_walls(FlowBlock& block) {
  for (int c = 0; c < block.n_dimensions; ++c) {
    const Box box = block.computed_faces(c);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for_each_interval(block.faces[c], j, k, box.begin[0], box.end[0], [&](int begin, int end) {
          for (int i = begin; i < end; ++i) {
            const int along = Triple{i, j, k}[c];
            if (along == -1 || (along == block.sizes[c] - 1 && block.decomposition->is_at_border(c, 1))) continue;
            for (int d = 0; d < block.n_dimensions; ++d)
              for (int side = 0; side < 2 && d != c; ++side) {
                const Triple cell{i, j, k};
                Triple beside = cell;
                beside[d] += side == 0 ? -1 : 1;
                const bool is_border =
                    block.decomposition->is_at_border(d, side) && (beside[d] < 0 || beside[d] >= block.sizes[d]);
                if (is_border || block.faces[c].contains(beside[0], beside[1], beside[2])) continue;
                const AxisMetrics& axis = block.axis[d];
                const double over = axis.inverse_width[cell[d]];
                block.inner_walls[c].push_back(
                    {cell, d, over * (2 * over - axis.inverse_distance[side == 0 ? cell[d] - 1 : cell[d]])});
              }
          }
        });
  }
}

}  // namespace

FixedSolid find_fixed_solid(const NavierStokesSetup& setup, const BlockDecomposition& decomposition) {
  return setup.bodies ? FixedSolid(setup.grid, decomposition, setup.bodies(0)) : FixedSolid();
}

FlowBorder::IsFluid fluid_of(const NavierStokesSetup& setup, const FixedSolid& solid) {
  if (solid.is_empty()) return setup.is_fluid;
  return [is_fluid = setup.is_fluid, &solid](const Point& centre) {
    return (!is_fluid || is_fluid(centre)) && !solid.contains(centre);
  };
}

FlowBlock make_flow_block(const NavierStokesSetup& setup, const BlockDecomposition& decomposition,
                          const FlowBorder& border, const FixedSolid& solid) {
  FlowBlock block;
  block.grid = &setup.grid;
  block.decomposition = &decomposition;
  block.n_dimensions = setup.grid.n_dimensions;
  const Box& mine = decomposition.mine();
  block.sizes = mine.sizes();
  const int n_ghosts = setup.bodies ? axis_margin : 2;  // images of walls reach further
  block.ghosts = {n_ghosts, n_ghosts, block.n_dimensions == 3 ? n_ghosts : 0};
  for (int d = 0; d < 3; ++d) block.axis[d] = make_axis_metrics(setup.grid.axis[d], mine.begin[d], mine.end[d]);

  const bool has_mask = setup.is_fluid || !solid.is_empty();
  const Triple n_cells = setup.grid.n_cells();
  const std::array<bool, 3> is_periodic = setup.grid.is_periodic();
  // Whether a cell, local and one beyond the block at most, is inside the grid and fluid.
  const auto is_fluid = [&](const Triple& cell) {
    Point centre;
    for (int d = 0; d < 3; ++d) {
      int global = mine.begin[d] + cell[d];
      if (is_periodic[d]) global = (global + n_cells[d]) % n_cells[d];
      if (global < 0 || global >= n_cells[d]) return false;
      centre[d] = setup.grid.axis[d].centre(global);
    }
    return (!setup.is_fluid || setup.is_fluid(centre)) && !solid.contains(cell);
  };
  const Box all = box_of(block.sizes);
  block.cells = has_mask ? ActiveCells::where(all,
                                              [&](int i, int j, int k) {
                                                return is_fluid({i, j, k});
                                              })
                         : ActiveCells::all(all);
  for (int d = 0; d < block.n_dimensions; ++d) {
    // With walls inside the grid also the faces beside the block, to see whether they are closed.
    Box range = setup.is_fluid ? all.grown({1, 1, block.n_dimensions == 3 ? 1 : 0}) : all;
    range.begin[d] = -1, range.end[d] = block.sizes[d];
    block.faces[d] = ActiveCells::where(range, [&](int i, int j, int k) {
      const Triple cell{i, j, k};
      Triple next = cell;
      ++next[d];
      const bool is_on_border = (cell[d] == -1 && decomposition.is_at_border(d, 0)) ||
                                (next[d] == block.sizes[d] && decomposition.is_at_border(d, 1));
      for (int e = 0; e < 3; ++e)
        if (is_on_border && e != d && (cell[e] < 0 || cell[e] >= block.sizes[e])) return false;  // nobody asks
      if (cell[d] == -1 && decomposition.is_at_border(d, 0)) return border.kind(d, 0, next) == BorderKind::opening;
      if (next[d] == block.sizes[d] && decomposition.is_at_border(d, 1))
        return border.kind(d, 1, cell) == BorderKind::opening;
      return is_fluid(cell) && is_fluid(next);
    });
  }
  if (setup.is_fluid) find_inner_walls(block);
  return block;
}

PressureProblem make_pressure_problem(const NavierStokesSetup& setup, const FlowBlock& block,
                                      const FlowBorder& border) {
  PressureProblem problem{
      .grid = block.grid, .decomposition = block.decomposition, .border_is_open = {}, .open_share = {}, .split = {}};
  bool needs_faces = setup.is_fluid || setup.bodies;
  for (int d = 0; d < block.n_dimensions; ++d)
    for (int side = 0; side < 2; ++side) {
      problem.border_is_open[d][side] = border.is_all_open(d, side);
      needs_faces |= border.is_partly_open(d, side) && !border.is_all_open(d, side);
    }
  if (!needs_faces) return problem;
  const Triple layer{1, 1, block.n_dimensions == 3 ? 1 : 0};
  FaceFractions& shares = problem.open_share.emplace();
  std::vector<Field<float>*> exchanged;
  for (int d = 0; d < 3; ++d) shares[d] = Field<float>(block.sizes, layer);
  for (int d = 0; d < block.n_dimensions; ++d) {
    const Box& range = block.faces[d].range();
    for (int k = range.begin[2]; k < range.end[2]; ++k)
      for (int j = range.begin[1]; j < range.end[1]; ++j)
        for (const Interval& interval : block.faces[d].row(j, k))
          for (int i = interval.begin; i < interval.end; ++i) shares[d](i, j, k) = 1;
    exchanged.push_back(&shares[d]);
  }
  HaloExchange(*block.decomposition).exchange(exchanged, 1);
  return problem;
}

}  // namespace couplet::flow
