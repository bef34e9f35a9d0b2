#pragma once
// Which cells of a level are merged into the cells of the next one, direction by direction.

#include <array>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/stretched_grid.hpp"

namespace couplet::flow {

/// The cells of one direction on one level, and the one-dimensional second difference on them:
/// (A phi)_i = lower(i) (phi_{i-1} - phi_i) + upper(i) (phi_{i+1} - phi_i).
struct LevelAxis {
  std::vector<double> width;             // (n_cells) [m]
  bool is_periodic = false;              //
  bool has_terms = true;                 // not along z in two dimensions
  std::array<bool, 2> border_is_open{};  // side 0: start, 1: end

  int n_cells() const { return static_cast<int>(width.size()); }
  double lower(int i) const;  // 1 / (width * distance between centres), half a cell at an open border [1/m^2]
  double upper(int i) const;
};

/// Coarse cell I holds the fine cells first[I] <= i < first[I + 1]: one, two or three of them.
struct Merging {
  std::vector<int> first;  // (n_coarse + 1)

  int n_coarse() const { return static_cast<int>(first.size()) - 1; }
  int n_fine() const { return first.back(); }
  bool has_border_at(int fine) const;
  int coarse_of(int fine) const;
};

/// All levels of a grid, finest first; merging[l][d] leads from level l to level l + 1.
struct LevelPlan {
  std::vector<std::array<LevelAxis, 3>> axes;
  std::vector<std::array<Merging, 3>> merging;

  int n_levels() const { return static_cast<int>(axes.size()); }
  Triple n_cells(int level) const;
};

/// Do red and black alternate across the ends of all periodic directions? They have an even number of cells, at
/// least 4.
bool can_colour(const std::array<LevelAxis, 3>& finest);

/// Two neighbours are merged where together they are at most four times as wide as the smallest cell of the level in
/// any direction that can still be merged; a cell left over joins a pair. So cells become cubes before they become
/// larger, and a point smoother does. A periodic direction keeps an even number of cells, at least 4, so that red and
/// black alternate across its ends. Ends where a level has at most `coarsest_size` cells.
/// Throws SceneError where the cells cannot be coloured.
LevelPlan plan_levels(const std::array<LevelAxis, 3>& finest);

inline constexpr int coarsest_size = 256;

/// Partitions of nearly equal parts whose borders are borders of coarse cells on as many of the next levels as possible
/// (at most 4 of them): what the multigrid can use without moving cells between ranks. Empty where some part would have
/// fewer than `smallest_block` cells. `level`: of the plan.
std::vector<Partition> aligned_partitions(const LevelPlan& plan, int level, const Triple& shape);

}  // namespace couplet::flow
