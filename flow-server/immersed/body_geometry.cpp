#include "flow-server/immersed/body_geometry.hpp"

#include <algorithm>

namespace couplet::flow {

namespace {

/// Cells beyond the block that are looked at: what images of ghosts reach, four, and one more for what lies between the
/// last faces. With four, forces differed by 1e-9 from rank to rank.
constexpr int n_layers = 5;

bool are_in_one_place(const BodySurface& a, const BodySurface& b) {
  return a.position == b.position && a.velocity == b.velocity && a.opening == b.opening && a.triangle == b.triangle;
}

}  // namespace

BodyGeometry::BodyGeometry(const FlowBlock& block, const BodyFlowSettings& settings)
    : crossings_(*block.grid, block.decomposition->mine(), n_layers),
      cut_(*block.grid, crossings_),
      pieces_(block, cut_),
      layer_(block, cut_, settings.wall) {}

void BodyGeometry::place(std::vector<BodySurface> surfaces) {
  std::vector<bool> has_moved(surfaces.size(), true);
  for (std::size_t s = 0; s < std::min(surfaces.size(), trees_.size()); ++s)
    has_moved[s] = !are_in_one_place(surfaces[s], surfaces_[s]);
  if (trees_.empty() || std::find(has_moved.begin(), has_moved.end(), true) != has_moved.end()) {
    surfaces_ = std::move(surfaces);
    crossings_.update(surfaces_);
    cut_.update(surfaces_);
    pieces_.update(surfaces_);
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      const std::array<SurfaceInTree, 1> in_tree{
          SurfaceInTree{&surfaces_[s], {}, static_cast<int>(surfaces_[s].triangle.size())}};
      if (trees_.size() <= s) {
        trees_.emplace_back(in_tree);
      } else if (has_moved[s]) {
        trees_[s].refit(in_tree);
      }
    }
    layer_.update(surfaces_, trees_);
  }
  changed_faces.clear();
  piece_pressure.assign(cut_.further_parts().size(), 0.0);
}

}  // namespace couplet::flow
