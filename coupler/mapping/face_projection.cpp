#include "coupler/mapping/face_projection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "coupler/mapping/face_shape.hpp"

namespace couplet::coupling {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int iterations_max = 30;
constexpr double step_tolerance = 1e-12;  // of coordinates of size 1

struct Place {
  Vector3d offset;  // from the point in space to the face
  Vector3d a, b;    // tangents
};

Place place_at(const FaceNodes& nodes, const Vector3d& point, const Vector2d& at) {
  const FaceShape shape = face_shape(static_cast<int>(nodes.cols()), at(0), at(1));
  Place place{-point, Vector3d::Zero(), Vector3d::Zero()};
  for (int k = 0; k < nodes.cols(); ++k) {
    place.offset += shape.value[k] * nodes.col(k);
    place.a += shape.along_a[k] * nodes.col(k);
    place.b += shape.along_b[k] * nodes.col(k);
  }
  return place;
}

/// Foot of the perpendicular, if the iteration finds one inside the face.
std::optional<FacePoint> project_inside(const FaceNodes& nodes, const Vector3d& point) {
  const bool triangle = is_triangle(static_cast<int>(nodes.cols()));
  Vector2d at = triangle ? Vector2d(1.0 / 3, 1.0 / 3) : Vector2d(0, 0);
  for (int iteration = 0; iteration < iterations_max; ++iteration) {
    const Place place = place_at(nodes, point, at);
    Eigen::Matrix2d normal_equations;
    normal_equations << place.a.dot(place.a), place.a.dot(place.b), place.a.dot(place.b), place.b.dot(place.b);
    const Vector2d step = normal_equations.inverse() * Vector2d(place.a.dot(place.offset), place.b.dot(place.offset));
    at -= step;
    if (!(at.cwiseAbs().maxCoeff() < 4)) return std::nullopt;  // far outside, or not a number on a folded face
    if (step.cwiseAbs().maxCoeff() > step_tolerance) continue;
    const bool inside = triangle ? at.minCoeff() >= 0 && at.sum() <= 1 : at.cwiseAbs().maxCoeff() <= 1;
    if (!inside) return std::nullopt;
    return FacePoint{at(0), at(1), place_at(nodes, point, at).offset.squaredNorm()};
  }
  return std::nullopt;
}

/// x(s) = start + s slope + s^2 bend, 0 <= s <= 1: an edge between two corners, through its midside node where there is
/// one.
struct Edge {
  Vector3d start, slope, bend;

  Vector3d offset(double along, const Vector3d& point) const { return start + along * (slope + along * bend) - point; }
};

Edge edge_between(const FaceNodes& nodes, int from, int to, int n_corners) {
  const Vector3d first = nodes.col(from), last = nodes.col(to);
  if (nodes.cols() == n_corners) return {first, last - first, Vector3d::Zero()};
  const Vector3d middle = nodes.col(n_corners + from);
  return {first, 4 * middle - 3 * first - last, 2 * first + 2 * last - 4 * middle};
}

struct EdgePoint {
  double along = 0;
  double squared_distance = std::numeric_limits<double>::infinity();
};

/// Gauss-Newton from the best of some places along the edge: the distance to a curved edge may have two minima.
EdgePoint project_on_edge(const Edge& edge, const Vector3d& point) {
  EdgePoint best;
  const auto consider = [&](double along) {
    const double squared_distance = edge.offset(along, point).squaredNorm();
    if (squared_distance < best.squared_distance) best = {along, squared_distance};
  };
  for (const double along : {0.0, 0.25, 0.5, 0.75, 1.0}) consider(along);
  double along = best.along;
  for (int iteration = 0; iteration < iterations_max; ++iteration) {
    const Vector3d tangent = edge.slope + 2 * along * edge.bend;
    const double next = std::clamp(along - tangent.dot(edge.offset(along, point)) / tangent.squaredNorm(), 0.0, 1.0);
    const double step = std::abs(next - along);
    along = next;
    if (!(step > step_tolerance)) break;
  }
  consider(along);
  return best;
}

}  // namespace

FacePoint project_on_face(const FaceNodes& nodes, const Vector3d& point) {
  if (const auto foot = project_inside(nodes, point)) return *foot;
  using Corners = std::array<Vector2d, 4>;
  const bool triangle = is_triangle(static_cast<int>(nodes.cols()));
  const int n_corners = triangle ? 3 : 4;
  const Corners corner = triangle ? Corners{Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)}
                                  : Corners{Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)};
  FacePoint best{0, 0, std::numeric_limits<double>::infinity()};
  for (int from = 0; from < n_corners; ++from) {
    const int to = (from + 1) % n_corners;
    const EdgePoint found = project_on_edge(edge_between(nodes, from, to, n_corners), point);
    if (!(found.squared_distance < best.squared_distance)) continue;
    // The ends are taken as they are, so that nodes get weights of exactly 0 and 1.
    const Vector2d at =
        found.along == 1 ? corner[to] : Vector2d(corner[from] + found.along * (corner[to] - corner[from]));
    best = {at(0), at(1), found.squared_distance};
  }
  return best;
}

}  // namespace couplet::coupling
