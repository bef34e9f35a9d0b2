#include "flow-server/immersed/prescribed_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace couplet::flow {
namespace {

RigidPose pose_of(const Translation& translation, double time) {
  RigidPose pose;
  for (int d = 0; d < 3; ++d) {
    const TimeFunction& displacement = translation.displacement[static_cast<std::size_t>(d)];
    pose.shift[d] = displacement.at(time);
    pose.shift_rate[d] = displacement.rate(time);
  }
  return pose;
}

/// x = c + R (X - c), R' = angle' n x R.
RigidPose pose_of(const Rotation& rotation, double time) {
  const Eigen::Vector3d axis = Eigen::Vector3d(rotation.axis.data()).normalized(), centre(rotation.through.data());
  Eigen::Matrix3d spin;  // n x
  spin << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  RigidPose pose;
  pose.rotation = Eigen::AngleAxisd(rotation.angle.at(time), axis).toRotationMatrix();
  pose.rotation_rate = rotation.angle.rate(time) * spin * pose.rotation;
  pose.shift = centre - pose.rotation * centre;
  pose.shift_rate = -pose.rotation_rate * centre;
  return pose;
}

}  // namespace

RigidPose RigidPose::after(const RigidPose& inner) const {
  RigidPose pose;
  pose.rotation = rotation * inner.rotation;
  pose.shift = rotation * inner.shift + shift;
  pose.rotation_rate = rotation_rate * inner.rotation + rotation * inner.rotation_rate;
  pose.shift_rate = rotation_rate * inner.shift + rotation * inner.shift_rate + shift_rate;
  return pose;
}

Eigen::Vector3d RigidPose::angular_velocity() const {
  const Eigen::Matrix3d spin = rotation_rate * rotation.transpose();
  return {spin(2, 1), spin(0, 2), spin(1, 0)};
}

bool PrescribedMotion::is_fixed() const {
  return std::all_of(joints_.begin(), joints_.end(), [](const Joint& joint) {
    if (const Rotation* rotation = std::get_if<Rotation>(&joint)) return rotation->angle.is_constant();
    const auto& displacement = std::get<Translation>(joint).displacement;
    return std::all_of(displacement.begin(), displacement.end(), [](const TimeFunction& f) { return f.is_constant(); });
  });
}

RigidPose PrescribedMotion::pose(double time) const {
  RigidPose pose;
  for (const Joint& joint : joints_)
    pose = pose.after(std::visit([time](const auto& kind) { return pose_of(kind, time); }, joint));
  return pose;
}

void PrescribedMotion::move(std::span<const Point> at_rest, double time, BodySurface& surface) const {
  const RigidPose now = pose(time);
  surface.position.resize(at_rest.size());
  surface.velocity.resize(at_rest.size());
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const Eigen::Vector3d rest(at_rest[i].data());
    Eigen::Vector3d::Map(surface.position[i].data()) = now.rotation * rest + now.shift;
    Eigen::Vector3d::Map(surface.velocity[i].data()) = now.rotation_rate * rest + now.shift_rate;
  }
}

}  // namespace couplet::flow
