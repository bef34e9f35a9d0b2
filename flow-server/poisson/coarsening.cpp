#include "flow-server/poisson/coarsening.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

// A pair may be that wide, over the smallest width of the level. With 4 the smallest width doubles from level to level;
// with 3, cycles converge no better and there are twice as many levels, with 6 they take half as many more.
constexpr double largest_pair = 4;
constexpr int largest_alignment = 4;  // levels that partitions look ahead
constexpr int smallest_periodic = 4;  // ghost layers must not reach around more than once

bool can_merge(const LevelAxis& axis) {
  return axis.has_terms && axis.n_cells() > (axis.is_periodic ? smallest_periodic : 1);
}

bool cannot_colour(const LevelAxis& axis) {
  return axis.has_terms && axis.is_periodic && (axis.n_cells() % 2 != 0 || axis.n_cells() < smallest_periodic);
}

Merging identity(int n_cells) {
  Merging merging;
  for (int i = 0; i <= n_cells; ++i) merging.first.push_back(i);
  return merging;
}

/// Pairs in each run of small cells, a triple at its end where the number is odd.
Merging merge_small_cells(const LevelAxis& axis, double largest_width) {
  const int n = axis.n_cells();
  Merging merging{{0}};
  const auto pair_fits = [&](int i) {
    return i + 1 < n && axis.width[i] + axis.width[i + 1] <= largest_width * (1 + 1e-9);
  };
  int i = 0;
  while (i < n) {
    if (!pair_fits(i)) {
      merging.first.push_back(++i);
      continue;
    }
    // A cell that would be left over between this pair and larger ones, or the end, joins it.
    const bool leaves_one =
        i + 2 < n && !pair_fits(i + 2) && axis.width[i + 1] + axis.width[i + 2] <= largest_width * (1 + 1e-9);
    i += leaves_one ? 3 : 2;
    merging.first.push_back(i);
  }
  return merging;
}

/// One coarse cell less or more, where red and black would not alternate around a periodic direction.
Merging made_even(Merging merging) {
  if (merging.n_coarse() % 2 == 0) return merging;
  std::vector<int>& first = merging.first;
  // Two triples, or a pair and a single cell, become one cell more or less; the widths stay comparable.
  if (merging.n_coarse() > smallest_periodic) {
    for (std::size_t c = 1; c + 1 < first.size(); ++c)
      if (first[c + 1] - first[c - 1] == 3) {  // a pair and a single: a triple
        first.erase(first.begin() + static_cast<std::ptrdiff_t>(c));
        return merging;
      }
    for (std::size_t c = 3; c < first.size(); ++c)
      if (first[c] - first[c - 3] == 6) {  // three pairs: two triples
        first[c - 2] = first[c - 3] + 3;
        first.erase(first.begin() + static_cast<std::ptrdiff_t>(c - 1));
        return merging;
      }
  }
  for (std::size_t c = 1; c < first.size(); ++c)
    if (first[c] - first[c - 1] > 1) {  // split a cell
      first.insert(first.begin() + static_cast<std::ptrdiff_t>(c), first[c - 1] + 1);
      return merging;
    }
  return merging;
}

LevelAxis merged(const LevelAxis& fine, const Merging& merging) {
  LevelAxis coarse = fine;
  coarse.width.assign(static_cast<std::size_t>(merging.n_coarse()), 0.0);
  for (int c = 0; c < merging.n_coarse(); ++c)
    for (int i = merging.first[c]; i < merging.first[c + 1]; ++i) coarse.width[c] += fine.width[i];
  return coarse;
}

}  // namespace

double LevelAxis::lower(int i) const {
  if (!has_terms) return 0;
  if (i > 0) return 1 / (width[i] * 0.5 * (width[i] + width[i - 1]));
  if (is_periodic) return 1 / (width[i] * 0.5 * (width[i] + width.back()));
  return border_is_open[0] ? 1 / (width[i] * 0.5 * width[i]) : 0;
}

double LevelAxis::upper(int i) const {
  if (!has_terms) return 0;
  if (i + 1 < n_cells()) return 1 / (width[i] * 0.5 * (width[i] + width[i + 1]));
  if (is_periodic) return 1 / (width[i] * 0.5 * (width[i] + width.front()));
  return border_is_open[1] ? 1 / (width[i] * 0.5 * width[i]) : 0;
}

bool Merging::has_border_at(int fine) const {
  return std::binary_search(first.begin(), first.end(), fine);
}

int Merging::coarse_of(int fine) const {
  return static_cast<int>(std::upper_bound(first.begin(), first.end(), fine) - first.begin()) - 1;
}

Triple LevelPlan::n_cells(int level) const {
  const auto& axis = axes[static_cast<std::size_t>(level)];
  return {axis[0].n_cells(), axis[1].n_cells(), axis[2].n_cells()};
}

bool can_colour(const std::array<LevelAxis, 3>& finest) {
  return std::none_of(finest.begin(), finest.end(), cannot_colour);
}

LevelPlan plan_levels(const std::array<LevelAxis, 3>& finest) {
  for (int d = 0; d < 3; ++d) {
    if (!cannot_colour(finest[d])) continue;
    throw report::SceneError(
        std::string("axis ") + "xyz"[d],
        "is periodic with " + std::to_string(finest[d].n_cells()) +
            " cells; the multigrid colours cells red and black, which needs an even number from 4 on",
        "give it an even number of cells, or use fast_diagonalisation");
  }
  LevelPlan plan;
  plan.axes.push_back(finest);
  while (true) {
    const Triple n = plan.n_cells(plan.n_levels() - 1);
    if (static_cast<std::int64_t>(n[0]) * n[1] * n[2] <= coarsest_size) break;
    const std::array<LevelAxis, 3> axes = plan.axes.back();
    // Somewhere a pair must fit, however much neighbours differ.
    double smallest = std::numeric_limits<double>::infinity(), smallest_pair = smallest;
    for (const LevelAxis& axis : axes) {
      if (!can_merge(axis)) continue;
      for (int i = 0; i < axis.n_cells(); ++i) {
        smallest = std::min(smallest, axis.width[i]);
        if (i > 0) smallest_pair = std::min(smallest_pair, axis.width[i - 1] + axis.width[i]);
      }
    }
    const double limit = std::max(largest_pair * smallest, smallest_pair);
    std::array<Merging, 3> merging;
    std::array<LevelAxis, 3> coarse;
    bool has_merged = false;
    for (int d = 0; d < 3; ++d) {
      merging[d] = can_merge(axes[d]) ? merge_small_cells(axes[d], limit) : identity(axes[d].n_cells());
      if (axes[d].is_periodic && axes[d].has_terms) {
        merging[d] = made_even(std::move(merging[d]));
        if (merging[d].n_coarse() < smallest_periodic) merging[d] = identity(axes[d].n_cells());
      }
      has_merged = has_merged || merging[d].n_coarse() < merging[d].n_fine();
      coarse[d] = merged(axes[d], merging[d]);
    }
    if (!has_merged) break;
    plan.merging.push_back(std::move(merging));
    plan.axes.push_back(std::move(coarse));
  }
  return plan;
}

std::vector<Partition> aligned_partitions(const LevelPlan& plan, int level, const Triple& shape) {
  std::vector<Partition> partitions;
  for (int d = 0; d < 3; ++d) {
    const int n = plan.n_cells(level)[d];
    // Candidates, coarsest first: fine cells at which a cell of the level `ahead` further on begins.
    bool has_found = false;
    for (int ahead = std::min(largest_alignment, plan.n_levels() - 1 - level); ahead >= 0 && !has_found; --ahead) {
      std::vector<int> borders;
      for (int c = 0; c <= plan.n_cells(level + ahead)[d]; ++c) {
        int fine = c;
        for (int l = level + ahead - 1; l >= level; --l)
          fine = plan.merging[static_cast<std::size_t>(l)][d].first[fine];
        borders.push_back(fine);
      }
      Partition partition;
      for (int p = 0; p <= shape[d]; ++p) {
        const int exact = static_cast<int>(static_cast<std::int64_t>(n) * p / shape[d]);
        auto next = std::lower_bound(borders.begin(), borders.end(), exact);
        if (next != borders.begin() && exact - *(next - 1) < *next - exact) --next;
        partition.start.push_back(*next);
      }
      // Shifted borders must not make the largest part much larger than the mean one.
      int largest = 0;
      for (int p = 0; p < shape[d]; ++p) largest = std::max(largest, partition.start[p + 1] - partition.start[p]);
      const bool is_even_enough = ahead <= 1 || largest <= std::max(1.1 * n / shape[d], 1.0 * n / shape[d] + 1);
      if (shape[d] > 1 && (partition.smallest_part() < smallest_block || !is_even_enough)) {
        if (ahead <= 1) return {};
        continue;
      }
      partitions.push_back(std::move(partition));
      has_found = true;
    }
  }
  return partitions;
}

}  // namespace couplet::flow
