#pragma once
// The nearest point of walls for places of velocities, and how wide the gap before a wall is.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "flow-server/immersed/surface_tree.hpp"

namespace couplet::flow {

/// Some of the surfaces, by their index. All from the 32nd on are in it, or none.
class SurfaceSet {
 public:
  void add(int surface) { bits_ |= bit(surface); }
  void add(SurfaceSet others) { bits_ |= others.bits_; }
  bool contains(int surface) const { return (bits_ & bit(surface)) != 0; }
  bool is_only(int surface) const { return surface < 31 && bits_ == bit(surface); }

 private:
  static std::uint32_t bit(int surface) { return 1u << (surface < 31 ? surface : 31); }
  std::uint32_t bits_ = 0;
};

/// What a place of a velocity knows of surfaces beside it.
struct NearbyWalls {
  SurfaceSet surfaces;   // that cut cells around it
  int last_closest = 0;  // of the points that were found from here the last one, counted from 1; 0: none
};

/// Answers the same question once: a place is asked for as a forced face, and as a ghost of neighbours on both sides.
class NearestWall {
 public:
  /// Both as they are from now on, in the same order; they must outlive the queries.
  void update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees);

  const BodySurface& surface(int index) const { return surfaces_[static_cast<std::size_t>(index)]; }

  /// On one surface.
  ClosestPoint on(int surface, const Eigen::Vector3d& place, double largest_distance, NearbyWalls& nearby);
  /// How far a surface is looked for [m].
  using Reach = std::function<double(const BodySurface&)>;
  /// On the one of those that cut cells around the place whose wall counts most there: that with the largest
  /// (1 - distance / reach) (1 - opening). So a free edge does not hide the wall behind it, and what counts is
  /// continuous in the place of the walls.
  ClosestPoint that_counts(const Eigen::Vector3d& place, const Reach& reach_of, NearbyWalls& nearby);
  /// Width of the gap that begins at a point of a wall [m]: that of the largest ball that touches the wall there and
  /// holds no other wall [Ma, Bae, Choi, Vis. Comput. 28 (2012) 7], `most` at most. It is continuous in the place of
  /// the walls, and knows two sides of one surface as well as two surfaces. A wall that opens recedes. `away`: unit
  /// vector into the gap.
  double gap(const ClosestPoint& wall, const Eigen::Vector3d& away, double most);
  /// Whether a ball holds no wall. `to_middle`: from a point of a wall to that of the ball [m].
  bool is_empty(const ClosestPoint& wall, const Eigen::Vector3d& to_middle, double radius);
  /// Whether all surfaces that cut cells around the place stand still.
  bool are_at_rest(const NearbyWalls& nearby) const;

  Eigen::Vector3d normal(const ClosestPoint& at) const;          // towards the outer side
  double velocity(const ClosestPoint& at, int component) const;  // [m/s]
  double opening(const ClosestPoint& at) const;

 private:
  /// Around a surface.
  struct Bounds {
    Eigen::Array3d low, high;
  };
  struct Found {
    ClosestPoint closest;
    int before;  // of the same place, counted from 1
  };

  /// On one surface, whatever cuts cells around the place.
  ClosestPoint find(int surface, const Eigen::Vector3d& place, double largest_distance, int& hint) const;
  /// On all of them, leaving out where they are wholly open; of those at the same distance the first one.
  ClosestPoint of_all(const Eigen::Vector3d& place, double largest_distance);

  std::span<const BodySurface> surfaces_;
  std::span<const SurfaceTree> trees_;
  std::vector<Bounds> bounds_;    // of each surface
  std::vector<bool> is_at_rest_;  // each surface
  std::vector<int> hint_;         // of each surface's tree: from the query before
  std::vector<int> hint_across_;  // likewise of gap()
  std::vector<Found> found_;
};

}  // namespace couplet::flow
