#pragma once
// From the walls in cut cells to the corners of surfaces.

#include <Eigen/Core>
#include <vector>

#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

/// Spreads sums over the points of walls to corners, each by the weights with which corners move that point: of forces
/// the work on any motion is kept. `Value`: a vector of Eigen of fixed size.
template <class Value>
class CornerSums {
 public:
  /// The geometry must outlive this.
  explicit CornerSums(const BodyGeometry& bodies)
      : bodies_(bodies), on_middle_(bodies.cut().middles().size(), Value::Zero()) {}

  /// To the points of the triangle as its mean velocity is made of theirs, a third each. Calls give(surface, corner,
  /// value); what the middle of the wall gets waits for spread_middles().
  template <class Give>
  void add(const WallTriangle& wall, const Value& value, const Give& give) {
    for (const WeighedPoint& end : wall.end)
      if (end.point) spread(*end.point, end.weight * value, give);
    on_middle_[static_cast<std::size_t>(wall.middle)] += value / 3;
  }

  /// Once, after all walls.
  template <class Give>
  void spread_middles(const Give& give) const {
    for (std::size_t m = 0; m < on_middle_.size(); ++m) {
      const WallMiddle& middle = bodies_.cut().middles()[m];
      for (int p = middle.first_point; p < middle.first_point + middle.n_points; ++p) {
        const WeighedPoint& corner = bodies_.cut().middle_points()[static_cast<std::size_t>(p)];
        spread(*corner.point, corner.weight * on_middle_[m], give);
      }
    }
  }

 private:
  template <class Give>
  void spread(const SurfacePoint& point, const Value& value, const Give& give) const {
    const auto s = static_cast<std::size_t>(point.surface);
    const auto& corners = bodies_.surfaces()[s].triangle[static_cast<std::size_t>(point.triangle)];
    for (std::size_t v = 0; v < 3; ++v)
      give(s, static_cast<std::size_t>(corners[v]), Value(point.weight[static_cast<Eigen::Index>(v)] * value));
  }

  const BodyGeometry& bodies_;
  std::vector<Value> on_middle_;
};

}  // namespace couplet::flow
