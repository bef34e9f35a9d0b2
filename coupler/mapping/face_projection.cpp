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

/// Closest point of an edge from one corner to another, starting from three places along it.
FacePoint project_on_edge(const FaceNodes& nodes, const Vector3d& point, const Vector2d& from, const Vector2d& to) {
  FacePoint best{0, 0, std::numeric_limits<double>::infinity()};
  const auto consider = [&](double along) {
    const Vector2d at = along <= 0 ? from : along >= 1 ? to : Vector2d(from + along * (to - from));
    const double squared_distance = place_at(nodes, point, at).offset.squaredNorm();
    if (squared_distance < best.squared_distance) best = {at(0), at(1), squared_distance};
  };
  for (double along : {0.0, 0.5, 1.0}) {
    consider(along);
    for (int iteration = 0; iteration < iterations_max; ++iteration) {
      const Place place = place_at(nodes, point, from + along * (to - from));
      const Vector3d tangent = (to - from)(0) * place.a + (to - from)(1) * place.b;
      const double next = std::clamp(along - tangent.dot(place.offset) / tangent.squaredNorm(), 0.0, 1.0);
      const double step = std::abs(next - along);
      along = next;
      if (!(step > step_tolerance)) break;
    }
    consider(along);
    if (nodes.cols() <= 4) break;  // straight edges have one minimum
  }
  return best;
}

}  // namespace

FacePoint project_on_face(const FaceNodes& nodes, const Vector3d& point) {
  if (const auto foot = project_inside(nodes, point)) return *foot;
  const bool triangle = is_triangle(static_cast<int>(nodes.cols()));
  const int n_corners = triangle ? 3 : 4;
  const std::array<Vector2d, 4> corner =
      triangle ? std::array<Vector2d, 4>{Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)}
               : std::array<Vector2d, 4>{Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)};
  FacePoint best{0, 0, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < n_corners; ++k) {
    const FacePoint candidate = project_on_edge(nodes, point, corner[k], corner[(k + 1) % n_corners]);
    if (candidate.squared_distance < best.squared_distance) best = candidate;
  }
  return best;
}

}  // namespace couplet::coupling
