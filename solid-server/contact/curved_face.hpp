#pragma once
// A deformed face of an element as a polynomial of its two face coordinates.

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "solid-server/element/lane_transpose.hpp"
#include "solid-server/mesh/element_shape.hpp"

namespace couplet::solid {

[[gnu::always_inline]] inline double dot(const NodeQuad& a, const NodeQuad& b) {
  const NodeQuad product = a * b;
  return product[0] + product[1] + product[2];
}

[[gnu::always_inline]] inline double length(const NodeQuad& a) {
  return std::sqrt(dot(a, a));
}

[[gnu::always_inline]] inline NodeQuad cross(const NodeQuad& a, const NodeQuad& b) {
  return NodeQuad{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}

/// Coordinates on a face: quadrilaterals -1 <= xi, eta <= 1; triangles xi, eta >= 0, xi + eta <= 1 with corners at
/// (0, 0), (1, 0), (0, 1).
using FaceCoordinates = Eigen::Vector2d;

constexpr int n_corners_of(FaceShape shape) {
  return shape == FaceShape::triangle6 ? 3 : 4;
}

/// Position and its derivatives by the face coordinates.
struct FacePoint {
  NodeQuad position, tangent_xi, tangent_eta, second_xi, second_mixed, second_eta;
};

/// A box along the axes.
struct Box {
  NodeQuad low, high;
};

/// The square of the distance from a point to a box, 0 inside [m^2].
[[gnu::always_inline]] inline double squared_distance(const NodeQuad& x, const Box& box) {
  const NodeQuad below = box.low - x, above = x - box.high;
  NodeQuad apart = below > above ? below : above;
  apart = apart > 0.0 ? apart : NodeQuad{};
  return dot(apart, apart);
}

/// x(xi, eta) = c0 + c1 xi + c2 eta + c3 xi^2 + c4 xi eta + c5 eta^2 + c6 xi^2 eta + c7 xi eta^2: all three shapes of
/// face lie in this space.
class CurvedFace {
 public:
  /// Positions x, y, z, 0 of the nodes of the face [m].
  CurvedFace(FaceShape shape, const std::array<NodeQuad, max_face_nodes>& node);

  FaceShape shape() const { return shape_; }
  [[gnu::always_inline]] FacePoint at(const FaceCoordinates& at) const {
    const double r = at.x(), s = at.y();
    const auto& c = c_;
    FacePoint point;
    point.position = c[0] + r * (c[1] + r * (c[3] + s * c[6])) + s * (c[2] + r * c[4] + s * (c[5] + r * c[7]));
    point.tangent_xi = c[1] + (2 * r) * (c[3] + s * c[6]) + s * (c[4] + s * c[7]);
    point.tangent_eta = c[2] + (2 * s) * (c[5] + r * c[7]) + r * (c[4] + r * c[6]);
    point.second_xi = 2 * (c[3] + s * c[6]);
    point.second_mixed = c[4] + (2 * r) * c[6] + (2 * s) * c[7];
    point.second_eta = 2 * (c[5] + r * c[7]);
    return point;
  }

  /// The right-hand unit normal, out of the body.
  NodeQuad normal(const FaceCoordinates& at) const;

  /// Edge k runs from corner k (s = -1) to the next (s = 1): x(s) = e0 + e1 s + e2 s^2.
  std::array<NodeQuad, 3> edge(int k) const;

  /// A box that holds the whole face, bulges included: that of its Bezier control points.
  Box box() const;

 private:
  FaceShape shape_;
  std::array<NodeQuad, max_face_nodes> node_;
  std::array<NodeQuad, 8> c_;
};

/// The face coordinates of the place s on edge k.
FaceCoordinates on_edge(FaceShape shape, int k, double s);

}  // namespace couplet::solid
