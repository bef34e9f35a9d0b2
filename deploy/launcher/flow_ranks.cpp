#include "deploy/launcher/flow_ranks.hpp"

#include <algorithm>
#include <string>

#include "deploy/launcher/server_estimate.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {

namespace {
/// With fewer cells a rank spends as long on messages as on cells.
constexpr double cells_worth_a_rank = 20000;

bool has_small_factors_only(int n) {
  for (const int factor : {2, 3})
    while (n % factor == 0) n /= factor;
  return n == 1;
}

}  // namespace

int ranks_for_cells(double n_cells, int n_cores) {
  const int most = std::clamp(static_cast<int>(std::min(n_cells / cells_worth_a_rank, 1e6)), 1, std::max(1, n_cores));
  // Blocks of 47 ranks would be slices, which hardly any grid is long enough for.
  int n_ranks = most;
  while (!has_small_factors_only(n_ranks)) --n_ranks;
  return n_ranks;
}

int choose_flow_ranks(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                      int n_cores) {
  if (scene.flow().navier_stokes().has_decomposition()) {
    const v1::Decomposition& blocks = scene.flow().navier_stokes().decomposition();
    const int n_blocks = blocks.x() * blocks.y() * blocks.z();
    if (options.flow_ranks > 0 && options.flow_ranks != n_blocks)
      throw report::SceneError(
          "--flow-ranks",
          std::to_string(options.flow_ranks) + " is not the number of blocks in the scene, " + std::to_string(n_blocks),
          "leave out --flow-ranks, or flow.navier_stokes.decomposition");
    return n_blocks;
  }
  if (options.flow_ranks > 0) return options.flow_ranks;
  if (!scene.flow().has_navier_stokes()) return 1;
  for (const Estimate& estimate : ask_for_estimate("flow-server", options.scene, options.settings, installation)) {
    if (estimate.name != "cells_active") continue;
    return ranks_for_cells(estimate.value, n_cores);
  }
  return 1;
}

}  // namespace couplet::launcher
