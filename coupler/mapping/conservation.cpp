#include "coupler/mapping/conservation.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace couplet::coupling {

namespace {

using Eigen::Vector3d;
using surface::NodeArray;

struct Sums {
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  double work = 0;
  double force_size = 0, moment_size = 0, work_size = 0;  // sums of magnitudes
};

bool is_vector_field(const NodeArray& field, const NodeArray& force) {
  return field.rows() == force.rows() && field.cols() == 3;
}

Eigen::Map<const Vector3d> vector_at(const NodeArray& field, Eigen::Index node) {
  return Eigen::Map<const Vector3d>(field.data() + 3 * node);
}

Vector3d centre_of(const InterfaceSide& side) {
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index node = 0; node < side.force.rows(); ++node)
    sum += vector_at(side.reference, node) + vector_at(side.displacement, node);
  return sum / static_cast<double>(side.force.rows());
}

Sums sums_of(const InterfaceSide& side, bool has_position, bool has_motion, const Vector3d& centre) {
  Sums sums;
  for (Eigen::Index node = 0; node < side.force.rows(); ++node) {
    const Vector3d force = vector_at(side.force, node);
    const double square = force.squaredNorm();
    sums.force += force;
    sums.force_size += std::sqrt(square);
    if (has_position) {
      const Vector3d arm = vector_at(side.reference, node) + vector_at(side.displacement, node) - centre;
      sums.moment += arm.cross(force);
      sums.moment_size += std::sqrt(arm.squaredNorm() * square);
    }
    if (has_motion) {
      const Vector3d motion = vector_at(side.motion, node);
      sums.work += motion.dot(force);
      sums.work_size += std::sqrt(motion.squaredNorm() * square);
    }
  }
  return sums;
}

double relative(double difference, double size_a, double size_b) {
  const double size = std::max(size_a, size_b);
  return size > 0 ? difference / size : 0;
}

}  // namespace

ConservationError compare_sides(const InterfaceSide& flow, const InterfaceSide& solid) {
  if (flow.force.cols() != 3 || solid.force.cols() != 3) return {};
  const auto has_position = [](const InterfaceSide& side) {
    return is_vector_field(side.reference, side.force) && is_vector_field(side.displacement, side.force);
  };
  const bool positions = has_position(flow) && has_position(solid);
  const bool motions = is_vector_field(flow.motion, flow.force) && is_vector_field(solid.motion, solid.force);
  const Vector3d centre = positions ? centre_of(flow) : Vector3d::Zero();
  const Sums a = sums_of(flow, positions, motions, centre), b = sums_of(solid, positions, motions, centre);
  return {relative((a.force - b.force).norm(), a.force_size, b.force_size),
          relative((a.moment - b.moment).norm(), a.moment_size, b.moment_size),
          relative(std::abs(a.work - b.work), a.work_size, b.work_size)};
}

}  // namespace couplet::coupling
