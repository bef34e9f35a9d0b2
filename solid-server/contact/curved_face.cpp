#include "solid-server/contact/curved_face.hpp"

#include <cmath>

namespace couplet::solid {

namespace {

constexpr std::array<std::array<double, 2>, 4> square_corner = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
constexpr std::array<std::array<double, 2>, 3> triangle_corner = {{{0, 0}, {1, 0}, {0, 1}}};

}  // namespace

CurvedFace::CurvedFace(FaceShape shape, const std::array<NodeQuad, max_face_nodes>& node)
    : shape_(shape), node_(node), c_{} {
  const auto& x = node;
  if (shape == FaceShape::triangle6) {
    c_[0] = x[0];
    c_[1] = 4 * x[3] - 3 * x[0] - x[1];
    c_[2] = 4 * x[5] - 3 * x[0] - x[2];
    c_[3] = 2 * x[0] + 2 * x[1] - 4 * x[3];
    c_[4] = 4 * (x[0] - x[3] + x[4] - x[5]);
    c_[5] = 2 * x[0] + 2 * x[2] - 4 * x[5];
    return;
  }
  const NodeQuad mean = (x[0] + x[1] + x[2] + x[3]) / 4;
  c_[4] = (x[0] - x[1] + x[2] - x[3]) / 4;
  const NodeQuad corner_xi = (x[1] + x[2] - x[0] - x[3]) / 4, corner_eta = (x[2] + x[3] - x[0] - x[1]) / 4;
  if (shape == FaceShape::quadrilateral4) {
    c_[0] = mean;
    c_[1] = corner_xi;
    c_[2] = corner_eta;
    return;
  }
  c_[0] = (x[4] + x[5] + x[6] + x[7]) / 2 - mean;
  c_[1] = (x[5] - x[7]) / 2;
  c_[2] = (x[6] - x[4]) / 2;
  c_[3] = mean - (x[4] + x[6]) / 2;
  c_[5] = mean - (x[5] + x[7]) / 2;
  c_[6] = corner_eta - c_[2];
  c_[7] = corner_xi - c_[1];
}

NodeQuad CurvedFace::normal(const FaceCoordinates& at) const {
  const FacePoint point = this->at(at);
  const NodeQuad n = cross(point.tangent_xi, point.tangent_eta);
  return n / std::sqrt(dot(n, n));
}

std::array<NodeQuad, 3> CurvedFace::edge(int k) const {
  const auto n_corners = static_cast<std::size_t>(n_corners_of(shape_)), a = static_cast<std::size_t>(k);
  const NodeQuad first = node_[a], last = node_[(a + 1) % n_corners], mean = (first + last) / 2;
  if (shape_ == FaceShape::quadrilateral4) return {mean, (last - first) / 2, NodeQuad{}};
  const NodeQuad middle = node_[n_corners + a];
  return {middle, (last - first) / 2, mean - middle};
}

/// Control points: corners, for each curved edge 2 x_mid - (x_a + x_b)/2, and for eight nodes the one in the middle of
/// the biquadratic patch whose point at (0, 0) is c0: 4 c0 - sum of corners/4 - sum of edges/2.
Box CurvedFace::box() const {
  Box box{node_[0], node_[0]};
  const auto hold = [&](const NodeQuad& x) { box = {x < box.low ? x : box.low, x > box.high ? x : box.high}; };
  const auto n_corners = static_cast<std::size_t>(n_corners_of(shape_));
  for (std::size_t a = 1; a < n_corners; ++a) hold(node_[a]);
  if (shape_ == FaceShape::quadrilateral4) return box;
  NodeQuad corners{}, edges{};
  for (std::size_t a = 0; a < n_corners; ++a) {
    const NodeQuad control = 2 * node_[n_corners + a] - (node_[a] + node_[(a + 1) % n_corners]) / 2;
    hold(control);
    corners += node_[a];
    edges += control;
  }
  if (shape_ == FaceShape::quadrilateral8) hold(4 * c_[0] - corners / 4 - edges / 2);
  return box;
}

FaceCoordinates on_edge(FaceShape shape, int k, double s) {
  const auto between = [&](const std::array<double, 2>& first, const std::array<double, 2>& last) {
    return FaceCoordinates{((1 - s) * first[0] + (1 + s) * last[0]) / 2, ((1 - s) * first[1] + (1 + s) * last[1]) / 2};
  };
  const auto a = static_cast<std::size_t>(k);
  if (shape == FaceShape::triangle6) return between(triangle_corner[a], triangle_corner[(a + 1) % 3]);
  return between(square_corner[a], square_corner[(a + 1) % 4]);
}

}  // namespace couplet::solid
