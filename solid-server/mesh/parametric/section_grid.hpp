#pragma once
// The nodes of a fold's cross-section: a structured grid of half elements.

#include <vector>

#include "solid-server/mesh/parametric/fold_section.hpp"

namespace couplet::solid {

/// i runs from the inferior (0) to the superior face (2 n_x), j from the wall (0) to the medial face (2 n_y); corner
/// nodes have two even indices, midside nodes one.
class SectionGrid {
 public:
  SectionGrid(const FoldSection& section, int n_x, int n_y);
  const Eigen::Vector2d& at(int i, int j) const;

 private:
  Eigen::Vector2d& point(int i, int j);
  void interpolate_from_sides();
  void smooth_corners();
  void straighten_inner_edges();

  int n_i_, n_j_;  // half elements in each direction
  std::vector<Eigen::Vector2d> point_;
};

}  // namespace couplet::solid
