#include "solid-server/contact/closest_point.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::solid {

namespace {

constexpr int most_steps = 30, most_halvings = 12;

// Newton squares its error: after a step of this size (of coordinates of order 1) only round-off is left.
constexpr double last_step = 1e-7;

// The area in which Newton may move, beyond the face on every side.
constexpr double margin = 0.25;

bool is_inside(FaceShape shape, const FaceCoordinates& at) {
  if (shape == FaceShape::triangle6) return at.x() >= 0 && at.y() >= 0 && at.x() + at.y() <= 1;
  return std::abs(at.x()) <= 1 && std::abs(at.y()) <= 1;
}

/// How much of a step stays within the margin: 0 to 1.
double allowed_share(FaceShape shape, const FaceCoordinates& at, const FaceCoordinates& step) {
  double share = 1;
  const auto keep_below = [&](double value, double change, double limit) {
    if (value + change > limit) share = std::min(share, std::max(0.0, (limit - value) / change));
  };
  if (shape == FaceShape::triangle6) {
    keep_below(-at.x(), -step.x(), margin / 2);
    keep_below(-at.y(), -step.y(), margin / 2);
    keep_below(at.x() + at.y(), step.x() + step.y(), 1 + margin / 2);
  } else {
    keep_below(at.x(), step.x(), 1 + margin);
    keep_below(-at.x(), -step.x(), 1 + margin);
    keep_below(at.y(), step.y(), 1 + margin);
    keep_below(-at.y(), -step.y(), 1 + margin);
  }
  return share;
}

/// The Newton step of phi = |x - p|^2 / 2: gradient -(x - p).t_k, Hessian t_k.t_l - (x - p).p,kl.
FaceCoordinates newton_step(const FacePoint& point, const NodeQuad& r) {
  const double g1 = dot(r, point.tangent_xi), g2 = dot(r, point.tangent_eta);
  const double m11 = dot(point.tangent_xi, point.tangent_xi), m12 = dot(point.tangent_xi, point.tangent_eta),
               m22 = dot(point.tangent_eta, point.tangent_eta);
  double h11 = m11 - dot(r, point.second_xi), h12 = m12 - dot(r, point.second_mixed),
         h22 = m22 - dot(r, point.second_eta);
  const double m = m11 * m22 - m12 * m12;
  double h = h11 * h22 - h12 * h12;
  if (!(h11 > 0 && h > 1e-2 * m)) {  // not convex here: without the second derivatives it always goes downhill
    h11 = m11;
    h12 = m12;
    h22 = m22;
    h = m;
  }
  return {(h22 * g1 - h12 * g2) / h, (h11 * g2 - h12 * g1) / h};
}

/// True when there is a minimum inside the face; then it is in `found`.
bool find_inside(const CurvedFace& face, const NodeQuad& x, ClosestPoint& found) {
  FaceCoordinates at = {0, 0};
  if (face.shape() == FaceShape::triangle6) at = {1.0 / 3, 1.0 / 3};
  FacePoint point = face.at(at);
  NodeQuad r = x - point.position;
  double squared = dot(r, r);
  for (int n = 0; n < most_steps; ++n) {
    const FaceCoordinates step = newton_step(point, r);
    double share = allowed_share(face.shape(), at, step);
    if (share < 1e-3) return false;  // it stands at the margin and wants to leave
    for (int halving = 0;; ++halving, share /= 2) {
      const FaceCoordinates next{at.x() + share * step.x(), at.y() + share * step.y()};
      const FacePoint next_point = face.at(next);
      const NodeQuad next_r = x - next_point.position;
      const double next_squared = dot(next_r, next_r);
      // At the end of the way round-off may let it rise.
      if (next_squared > squared * (1 + 1e-12) && halving < most_halvings) continue;
      at = next;
      point = next_point;
      r = next_r;
      squared = next_squared;
      break;
    }
    if (std::max(std::abs(step.x()), std::abs(step.y())) > last_step) continue;
    if (!is_inside(face.shape(), at)) return false;
    found = {at, point.position, std::sqrt(squared), -1, -1};
    return true;
  }
  return false;
}

/// The closest point of an edge; `s` comes back in [-1, 1].
ClosestPoint find_on_edge(const CurvedFace& face, const std::array<NodeQuad, 3>& e, const NodeQuad& x, int k) {
  const auto position = [&](double s) { return e[0] + s * (e[1] + s * e[2]); };
  // phi' = -(x - e).e' is a cubic; from the projection on the chord a few Newton steps, kept downhill by halving
  double s = std::clamp(dot(x - e[0], e[1]) / dot(e[1], e[1]), -1.0, 1.0);
  NodeQuad r = x - position(s);
  double squared = dot(r, r);
  for (int n = 0; n < most_steps; ++n) {
    const NodeQuad slope = e[1] + (2 * s) * e[2];
    const double m = dot(slope, slope), h = m - 2 * dot(r, e[2]);
    const double target = std::clamp(s + dot(r, slope) / (h > 1e-2 * m ? h : m), -1.0, 1.0);
    double step = target - s;
    for (int halving = 0;; ++halving, step /= 2) {
      const NodeQuad next_r = x - position(s + step);
      const double next_squared = dot(next_r, next_r);
      if (next_squared > squared * (1 + 1e-12) && halving < most_halvings) continue;
      r = next_r;
      squared = next_squared;
      break;
    }
    // A full step ends on the bound itself, not beside it by round-off.
    const double moved = target - s;
    s = step == moved ? target : s + step;
    if (std::abs(moved) < last_step) break;
  }
  ClosestPoint found{on_edge(face.shape(), k, s), position(s), std::sqrt(squared), k, -1};
  if (s <= -1) found.corner = k;
  if (s >= 1) found.corner = (k + 1) % n_corners_of(face.shape());
  return found;
}

}  // namespace

ClosestPoint closest_point(const CurvedFace& face, const NodeQuad& x, double within) {
  ClosestPoint closest;
  if (find_inside(face, x, closest)) return closest;
  closest.distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < n_corners_of(face.shape()); ++k) {
    const auto edge = face.edge(k);
    // The edge lies within |e1| + |e2| around its middle.
    const double reach = std::min(within, closest.distance) + length(edge[1]) + length(edge[2]);
    if (length(x - edge[0]) > reach) continue;
    const ClosestPoint on_this = find_on_edge(face, edge, x, k);
    if (on_this.distance < closest.distance) closest = on_this;
  }
  return closest;
}

}  // namespace couplet::solid
