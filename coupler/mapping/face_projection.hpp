#pragma once
// The point of a face that is closest to a point in space.

#include <Eigen/Core>

namespace couplet::coupling {

using FaceNodes = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 8>;  // a column a node

struct FacePoint {
  double a = 0, b = 0;          // coordinates on the face, as in face_shape.hpp
  double squared_distance = 0;  // [m^2]
};

/// Gauss-Newton iteration inside the face, and where that leaves the face, along each of its edges. Exact on flat
/// triangles and parallelograms; on curved faces to round-off unless the point is farther away than the radius of
/// curvature.
FacePoint project_on_face(const FaceNodes& nodes, const Eigen::Vector3d& point);

}  // namespace couplet::coupling
