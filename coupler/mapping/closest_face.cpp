#include "coupler/mapping/closest_face.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "coupler/mapping/face_projection.hpp"
#include "coupler/mapping/face_shape.hpp"

namespace couplet::coupling {

namespace {

using Box = Eigen::AlignedBox3d;
using Eigen::Vector3d;

FaceNodes nodes_of(const surface::SurfaceMesh& mesh, std::int64_t face) {
  const auto first = mesh.face_offset(face), count = mesh.face_offset(face + 1) - first;
  FaceNodes nodes(3, count);
  for (std::int64_t k = 0; k < count; ++k) nodes.col(k) = mesh.node_position.row(mesh.face_node(first + k)).transpose();
  return nodes;
}

/// A box that a face does not leave: around its nodes, and for a quadratic face around the control points of its Bezier
/// form, which are 2 m - (c + c') / 2 for an edge from corner c to c' with midside node m, and one in the middle.
Box box_around(const FaceNodes& nodes) {
  Box box;
  for (int k = 0; k < nodes.cols(); ++k) box.extend(Vector3d(nodes.col(k)));
  if (nodes.cols() <= 4) return box;
  const int n_corners = static_cast<int>(nodes.cols()) / 2;
  Vector3d corners = Vector3d::Zero(), midsides = Vector3d::Zero(), controls = Vector3d::Zero();
  for (int k = 0; k < n_corners; ++k) {
    const Vector3d control = 2 * nodes.col(n_corners + k) - 0.5 * (nodes.col(k) + nodes.col((k + 1) % n_corners));
    box.extend(control);
    corners += nodes.col(k);
    midsides += nodes.col(n_corners + k);
    controls += control;
  }
  // The middle of a quadrilateral, x = midsides / 2 - corners / 4 = corners / 16 + controls / 8 + middle control / 4
  if (n_corners == 4) box.extend(Vector3d(2 * midsides - 1.25 * corners - 0.5 * controls));
  return box;
}

struct FaceQuery {
  using Scalar = double;
  const surface::SurfaceMesh& mesh;
  Vector3d point;
  std::int64_t face = -1;
  FacePoint found{0, 0, std::numeric_limits<double>::infinity()};

  double minimumOnVolume(const Box& box) const { return box.squaredExteriorDistance(point); }  // NOLINT: Eigen's name
  double minimumOnObject(std::int64_t candidate) {                                             // NOLINT
    const FacePoint here = project_on_face(nodes_of(mesh, candidate), point);
    const bool is_closer = here.squared_distance < found.squared_distance ||
                           (here.squared_distance == found.squared_distance && candidate < face);
    if (is_closer) {
      face = candidate;
      found = here;
    }
    return here.squared_distance;
  }
};

/// offset = along_a a + along_b b + gap n
struct Offset {
  double along_a, along_b, gap;
  Vector3d normal;
};

Offset split(const Vector3d& offset, const FaceNodes& nodes, const FaceShape& shape) {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  for (int k = 0; k < nodes.cols(); ++k) {
    a += shape.along_a[k] * nodes.col(k);
    b += shape.along_b[k] * nodes.col(k);
  }
  const Vector3d normal = a.cross(b).normalized();
  Eigen::Matrix3d basis;
  basis << a, b, normal;
  const Vector3d parts = basis.inverse() * offset;
  const double face_width = is_triangle(static_cast<int>(nodes.cols())) ? 1 : 2;
  return {std::clamp(parts(0), -face_width, face_width), std::clamp(parts(1), -face_width, face_width), parts(2),
          normal};
}

class FaceFollower {
 public:
  FaceFollower(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid) : flow_(flow), solid_(solid) {
    Box all;
    std::vector<std::int64_t> faces;
    std::vector<Box> boxes;
    for (std::int64_t face = 0; face < solid.n_faces(); ++face) {
      faces.push_back(face);
      boxes.push_back(box_around(nodes_of(solid, face)));
      all.extend(boxes.back());
    }
    tree_.init(faces.begin(), faces.end(), boxes.begin(), boxes.end());
    smallest_gap_ = 1e-13 * all.diagonal().norm();  // below it is round-off of the positions
  }

  void follow(std::int64_t node) {
    FaceQuery query{solid_, flow_.node_position.row(node).transpose()};
    Eigen::BVMinimize(tree_, query);
    const FaceNodes nodes = nodes_of(solid_, query.face);
    const int n_nodes = static_cast<int>(nodes.cols());
    const FaceShape shape = face_shape(n_nodes, query.found.a, query.found.b);
    Vector3d offset = query.point;
    for (int k = 0; k < n_nodes; ++k) offset -= shape.value[k] * nodes.col(k);
    const Offset parts = split(offset, nodes, shape);
    const auto first = solid_.face_offset(query.face);
    for (int k = 0; k < n_nodes; ++k) {
      const double weight = shape.value[k] + parts.along_a * shape.along_a[k] + parts.along_b * shape.along_b[k];
      if (weight != 0) entries_.emplace_back(node, solid_.face_node(first + k), weight);
    }
    result_.largest_distance = std::max(result_.largest_distance, offset.norm());
    if (std::abs(parts.gap) > smallest_gap_) add_arm(node, query.face, shape, parts);
  }

  Interpolation result() {
    result_.weights.resize(flow_.n_nodes(), solid_.n_nodes());
    result_.weights.setFromTriplets(entries_.begin(), entries_.end());
    return std::move(result_);
  }

 private:
  void add_arm(std::int64_t node, std::int64_t face, const FaceShape& shape, const Offset& parts) {
    NormalArm arm;
    arm.flow_node = node;
    arm.gap = parts.gap;
    const auto first = solid_.face_offset(face);
    arm.n_nodes = static_cast<int>(solid_.face_offset(face + 1) - first);
    for (int k = 0; k < arm.n_nodes; ++k) arm.solid_node[k] = solid_.face_node(first + k);
    arm.along_a = shape.along_a;
    arm.along_b = shape.along_b;
    arm.reference_normal = parts.normal;
    result_.arms.push_back(arm);
  }

  const surface::SurfaceMesh& flow_;
  const surface::SurfaceMesh& solid_;
  Eigen::KdBVH<double, 3, std::int64_t> tree_;
  double smallest_gap_ = 0;
  std::vector<Eigen::Triplet<double, std::int64_t>> entries_;
  Interpolation result_;
};

}  // namespace

Interpolation follow_closest_faces(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid) {
  FaceFollower follower(flow, solid);
  for (std::int64_t node = 0; node < flow.n_nodes(); ++node) follower.follow(node);
  return follower.result();
}

}  // namespace couplet::coupling
