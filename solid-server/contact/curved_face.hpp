#pragma once
// A deformed face of an element as a polynomial of its two face coordinates.

#include <Eigen/Core>
#include <array>

#include "solid-server/element/lane_transpose.hpp"
#include "solid-server/mesh/element_shape.hpp"

namespace couplet::solid {

[[gnu::always_inline]] inline double dot(const NodeQuad& a, const NodeQuad& b) {
  const NodeQuad product = a * b;
  return product[0] + product[1] + product[2];
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

/// x(xi, eta) = c0 + c1 xi + c2 eta + c3 xi^2 + c4 xi eta + c5 eta^2 + c6 xi^2 eta + c7 xi eta^2: all three shapes of
/// face lie in this space.
class CurvedFace {
 public:
  /// Positions x, y, z, 0 of the nodes of the face [m].
  CurvedFace(FaceShape shape, const std::array<NodeQuad, max_face_nodes>& node);

  FaceShape shape() const { return shape_; }
  FacePoint at(const FaceCoordinates& at) const;

  /// The right-hand unit normal, out of the body.
  NodeQuad normal(const FaceCoordinates& at) const;

  /// Edge k runs from corner k (s = -1) to the next (s = 1): x(s) = e0 + e1 s + e2 s^2.
  std::array<NodeQuad, 3> edge(int k) const;

  /// A box that holds the whole face, bulges included: that of its Bezier control points.
  struct Box {
    NodeQuad low, high;
  };
  Box box() const;

  /// Middle of the corners, and a radius around it within which the face lies [m].
  NodeQuad middle() const;
  double radius() const;

 private:
  template <class Visit>
  void for_each_control_point(const Visit& visit) const;

  FaceShape shape_;
  std::array<NodeQuad, max_face_nodes> node_;
  std::array<NodeQuad, 8> c_;
};

/// The face coordinates of the place s on edge k.
FaceCoordinates on_edge(FaceShape shape, int k, double s);

}  // namespace couplet::solid
