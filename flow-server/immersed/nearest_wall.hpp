#pragma once
// The nearest point of all surfaces around a place, and how wide the gap before a wall is.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "flow-server/immersed/surface_tree.hpp"

namespace couplet::flow {

Eigen::Vector3d to_vector(const Point& point);
Eigen::Vector3d unit_normal(const BodySurface& surface, int triangle);
/// Of a surface at a point of it [m/s].
double velocity_at(const BodySurface& surface, const ClosestPoint& point, int component);
/// Between 0 and 1, where the surface is open.
double opening_at(const BodySurface& surface, const ClosestPoint& point);

class NearestWall {
 public:
  /// `trees`: one of each surface. All must outlive this, or the next call.
  void update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees);

  /// Of one surface. Distances in m; not found beyond the largest one.
  ClosestPoint on(int surface, const Eigen::Vector3d& point, double largest_distance);
  /// Of all surfaces, leaving out where they are wholly open; of those at the same distance the first one.
  ClosestPoint of_all(const Eigen::Vector3d& point, double largest_distance);
  /// The one whose wall counts most at a point: that with the largest (1 - distance / reach) (1 - opening). So a free
  /// edge does not hide the wall behind it, and what counts is continuous in the place of the walls.
  ClosestPoint that_counts(const Eigen::Vector3d& point, double reach_of_closed, double reach_of_sheets);
  /// Width of the gap that begins at a point of a wall [m]: that of the largest ball that touches the wall there and
  /// holds no other wall [Ma, Bae, Choi, Vis. Comput. 28 (2012) 7], `most` at most. It is continuous in the place of
  /// the walls, and knows two sides of one surface as well as two surfaces. A wall that opens recedes. `away`: unit
  /// vector into the gap.
  double gap(const Eigen::Vector3d& wall, const Eigen::Vector3d& away, double most);

 private:
  /// Around a surface.
  struct Bounds {
    Eigen::Array3d low, high;
  };
  std::span<const BodySurface> surfaces_;
  std::span<const SurfaceTree> trees_;
  std::vector<Bounds> bounds_;  // of each surface
  std::vector<int> hint_;       // of each surface's tree: from the query before
};

}  // namespace couplet::flow
