#pragma once
// The nearest point of surfaces.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/surface_topology.hpp"

namespace couplet::flow {

struct ClosestPoint {
  int surface = -1;                // -1: nothing within the largest distance
  int triangle = -1;               // of that surface
  std::array<double, 3> weight{};  // of the corners; 0 for those that the point does not depend on, exactly
  Point position{};                // of the closest point [m]
  double distance = 0;             // [m]
  bool is_on_free_edge = false;    // the surface ends there: the asking point lies beyond it, or on the edge
  int hint = -1;                   // for the next query nearby

  bool is_found() const { return surface >= 0; }
};

/// A surface as the tree sees it: the first n_triangles of it, so that a strip beyond its edges can be left out.
struct SurfaceInTree {
  const BodySurface* surface;
  std::span<const FreeEdge> free_edge;
  int n_triangles;
};

/// Boxes around triangles, eight in a node, over one or more surfaces. Built once and fitted anew when they move. The
/// answer does not depend on the hint: of triangles at the same distance (but for round-off) the first one counts.
class SurfaceTree {
 public:
  explicit SurfaceTree(std::span<const SurfaceInTree> surfaces);

  /// After the surfaces have moved; the same surfaces in the same order. Builds the tree anew when its boxes have grown
  /// so much that queries would suffer.
  void refit(std::span<const SurfaceInTree> surfaces);

  /// A hint is that of a query near by; -1: none.
  ClosestPoint closest(const Point& point, double largest_distance, int hint = -1) const;

  int n_triangles() const { return static_cast<int>(number_.size()); }

 private:
  static constexpr int n_lanes = 8;
  // Coordinates of eight boxes or triangles side by side, so that one instruction works on all.
  using Singles = Eigen::Array<float, n_lanes, 1>;
  using Doubles = Eigen::Array<double, n_lanes, 1>;
  /// Boxes in single precision, rounded outwards; unused ones are infinitely far.
  struct Node {
    std::array<Singles, 3> low, high;
    std::array<std::int32_t, n_lanes> child;  // >= 0: node; < 0: leaf ~child
  };
  /// Corners of up to eight triangles [corner][axis], the last one repeated.
  struct Leaf {
    std::array<std::array<Doubles, 3>, 3> corner;
  };
  struct Item {
    std::array<float, 3> middle;
    std::int32_t triangle;
  };
  struct Box {
    std::array<float, 3> low, high;
  };

  void build(std::span<const SurfaceInTree> surfaces);
  std::int32_t build_child(std::span<Item> items, std::int32_t first_leaf);
  void fit(std::span<const SurfaceInTree> surfaces);
  Box box_of(std::int32_t child) const;
  Box box_of_leaf(std::size_t leaf) const;
  double area_of_boxes() const;
  /// Squared distances up to this one may differ from the nearest by round-off of the positions (1e-16 of the size)
  /// alone.
  double farthest_tie(double nearest) const { return nearest * (1 + 1e-9) + 1e-23 * size_ * size_; }
  void compare(std::int32_t place, const Point& point, double& nearest, ClosestPoint& found) const;
  void compare_leaf(std::int32_t leaf, const Point& point, double& nearest, ClosestPoint& found) const;

  std::vector<Node> node_;  // children after their parent; the root first
  std::vector<Leaf> leaf_;
  // Of triangles, by their place: 8 * leaf + lane.
  std::vector<std::int32_t> surface_;
  std::vector<std::int32_t> number_;  // in its surface
  std::vector<std::uint8_t> free_;    // bit k: the side from corner k to the next; bit 3 + k: corner k
  double size_ = 0;                   // of everything [m]
  double built_area_ = 0;             // of all boxes when they were built [m^2]
};

}  // namespace couplet::flow
