#include "coupler/mapping/normal_arm.hpp"

#include <Eigen/Geometry>

namespace couplet::coupling {

namespace {

using Eigen::Vector3d;
using surface::NodeArray;

struct Tangents {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
};

// Rows have three numbers, one after the other; a loop over single numbers is several times slower here.
Eigen::Map<const Vector3d> node_value(const NodeArray& field, std::int64_t node) {
  return Eigen::Map<const Vector3d>(field.data() + 3 * node);
}

Tangents tangents_of(const NormalArm& arm, const NodeArray& field) {
  Tangents tangents;
  for (int k = 0; k < arm.n_nodes; ++k) {
    const Vector3d value = node_value(field, arm.solid_node[k]);
    tangents.a += arm.along_a[k] * value;
    tangents.b += arm.along_b[k] * value;
  }
  return tangents;
}

Tangents present_tangents(const NormalArm& arm, const NodeArray& reference, const NodeArray& displacement) {
  Tangents tangents;
  for (int k = 0; k < arm.n_nodes; ++k) {
    const Vector3d value = node_value(reference, arm.solid_node[k]) + node_value(displacement, arm.solid_node[k]);
    tangents.a += arm.along_a[k] * value;
    tangents.b += arm.along_b[k] * value;
  }
  return tangents;
}

}  // namespace

Vector3d arm_normal(const NormalArm& arm, const NodeArray& reference, const NodeArray& displacement) {
  const Tangents t = present_tangents(arm, reference, displacement);
  return t.a.cross(t.b).normalized();
}

Vector3d arm_velocity(const NormalArm& arm, const NodeArray& reference, const NodeArray& displacement,
                      const NodeArray& velocity) {
  const Tangents t = present_tangents(arm, reference, displacement), rate = tangents_of(arm, velocity);
  const Vector3d c = t.a.cross(t.b), n = c.normalized();
  const Vector3d c_rate = rate.a.cross(t.b) + t.a.cross(rate.b);
  return arm.gap / c.norm() * (c_rate - n * n.dot(c_rate));
}

void add_arm_force(const NormalArm& arm, const NodeArray& reference, const NodeArray& displacement,
                   const Vector3d& force, NodeArray& solid_force) {
  const Tangents t = present_tangents(arm, reference, displacement);
  const Vector3d c = t.a.cross(t.b), n = c.normalized();
  const Vector3d q = arm.gap / c.norm() * (force - n * n.dot(force));
  const Vector3d along_a = t.b.cross(q), along_b = q.cross(t.a);
  for (int k = 0; k < arm.n_nodes; ++k)
    solid_force.row(arm.solid_node[k]).head<3>() += (arm.along_a[k] * along_a + arm.along_b[k] * along_b).transpose();
}

}  // namespace couplet::coupling
