#pragma once
// A flow node that stands off the solid's face is carried by the face's normal, so that it turns with the face.

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

/// Face nodes x_k give tangents a = sum_k along_a[k] x_k and b = sum_k along_b[k] x_k, and the normal n = c / |c|, c =
/// a x b. The flow node stands at gap n off the point of the face that it follows.
struct NormalArm {
  std::int64_t flow_node = 0;
  double gap = 0;  // [m], negative: on the solid's side
  int n_nodes = 0;
  std::array<std::int64_t, 8> solid_node{};
  std::array<double, 8> along_a{}, along_b{};  // derivatives of the face's shape functions
  Eigen::Vector3d reference_normal = Eigen::Vector3d::Zero();
};

/// Normal of the face at solid positions X + u.
Eigen::Vector3d arm_normal(const NormalArm& arm, const surface::NodeArray& reference,
                           const surface::NodeArray& displacement);

/// Rate of gap n when the solid's nodes move with `velocity`: gap (I - n n^T) (a' x b + a x b') / |c|.
Eigen::Vector3d arm_velocity(const NormalArm& arm, const surface::NodeArray& reference,
                             const surface::NodeArray& displacement, const surface::NodeArray& velocity);

/// Adds to the solid's nodal forces what `force` at the end of the arm does to the face beside its own value: the
/// transpose of arm_velocity, which is a couple. With q = gap (I - n n^T) force / |c|, node k gets along_a[k] b x q +
/// along_b[k] q x a.
void add_arm_force(const NormalArm& arm, const surface::NodeArray& reference, const surface::NodeArray& displacement,
                   const Eigen::Vector3d& force, surface::NodeArray& solid_force);

}  // namespace couplet::coupling
