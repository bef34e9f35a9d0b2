#pragma once
// Elements whose nodes stand in a wrong order.

#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// The range of det(dX/dxi) over an element's corners and quadrature points [m^3].
struct JacobianRange {
  double smallest = 0, largest = 0;
};

/// Measures elements of one shape.
class JacobianMeasure {
 public:
  explicit JacobianMeasure(ElementShape shape);
  /// `position`: (3, n_nodes).
  JacobianRange of(const Eigen::Matrix3Xd& position) const;

 private:
  Eigen::Index n_points_ = 0;
  Eigen::MatrixXd gradient_;  // dN_a/dxi_k, (k n_points + point, a): so that all points are computed at once
};

/// How far along its edge a midside node stands, from 0 at the edge's first corner to 1, and how far from the middle,
/// over the length of the edge.
struct MidsidePlace {
  double along = 0, from_middle = 0;
  bool is_good() const { return along >= 0.25 && along <= 0.75 && from_middle <= 0.5; }
};

/// One entry for each edge; none for shapes without midside nodes.
std::vector<MidsidePlace> midside_places(ElementShape shape, const Eigen::Matrix3Xd& position);

/// True when another known order of the same nodes gives a good element: bottom and top exchanged (mirrored), corners
/// row by row, midside nodes edge by edge in any order.
bool would_be_good_in_another_order(ElementShape shape, const Eigen::Matrix3Xd& position,
                                    const JacobianMeasure& measure);

}  // namespace couplet::solid
