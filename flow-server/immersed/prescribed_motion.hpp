#pragma once
// The motion of a rigid body that is given over time, through joints.

#include <Eigen/Core>
#include <array>
#include <span>
#include <variant>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/time_function.hpp"

namespace couplet::flow {

/// Where a rigid body is at one time and how it moves: x = R X + p, u = R' X + p', X where it lies at rest.
struct RigidPose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();   // R
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();          // p [m]
  Eigen::Matrix3d rotation_rate = Eigen::Matrix3d::Zero();  // R' [1/s]
  Eigen::Vector3d shift_rate = Eigen::Vector3d::Zero();     // p' [m/s]

  /// This pose after that of an inner joint: x = R (R_i X + p_i) + p.
  RigidPose after(const RigidPose& inner) const;
  Eigen::Vector3d angular_velocity() const;  // w of R' R^T = w x [1/s]
};

struct Translation {
  std::array<TimeFunction, 3> displacement;  // [m]
};

/// About an axis through a point, both where the body lies at rest; right-handed.
struct Rotation {
  Point through{};      // [m]
  Point axis{0, 0, 1};  // any length but zero
  TimeFunction angle;   // [rad]
};

using Joint = std::variant<Translation, Rotation>;

/// Joints from the world to the body: each carries those that follow. A wing that hangs on a moving body has the joints
/// of that body first; stroke, deviation and pitch are three rotations in this order, each about its axis in the body
/// at rest. Positions and velocities are exact at any time, but for formulas (time_function.hpp).
class PrescribedMotion {
 public:
  PrescribedMotion() = default;
  explicit PrescribedMotion(std::vector<Joint> joints) : joints_(std::move(joints)) {}

  const std::vector<Joint>& joints() const { return joints_; }
  bool is_fixed() const;  // never moves
  RigidPose pose(double time) const;

  /// Sets positions and velocities of the surface from the positions at rest.
  void move(std::span<const Point> at_rest, double time, BodySurface& surface) const;

 private:
  std::vector<Joint> joints_;
};

}  // namespace couplet::flow
