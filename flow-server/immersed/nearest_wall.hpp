#pragma once
// The nearest point of walls for places of velocities.

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
  /// On those that cut cells around the place; of some at the same distance the first one counts. Each is overlooked
  /// beyond its own reach.
  ClosestPoint on_any(const Eigen::Vector3d& place, const Reach& reach_of, NearbyWalls& nearby);
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

  std::span<const BodySurface> surfaces_;
  std::span<const SurfaceTree> trees_;
  std::vector<Bounds> bounds_;    // of each surface
  std::vector<bool> is_at_rest_;  // each surface
  std::vector<int> hint_;         // of each surface's tree: from the query before
  std::vector<Found> found_;
};

}  // namespace couplet::flow
