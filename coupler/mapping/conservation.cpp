#include "coupler/mapping/conservation.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace couplet::coupling {

namespace {

using Eigen::RowVector3d;

struct Sum {
  Eigen::VectorXd value;
  double magnitude = 0;
};

double relative_difference(const Sum& a, const Sum& b) {
  const double scale = std::max(a.magnitude, b.magnitude);
  return scale > 0 ? (a.value - b.value).norm() / scale : 0;
}

Sum total_force(const InterfaceSide& side) {
  return {side.force.colwise().sum().transpose(), side.force.rowwise().norm().sum()};
}

Sum total_moment(const InterfaceSide& side, const RowVector3d& centre) {
  RowVector3d moment = RowVector3d::Zero();
  double magnitude = 0;
  for (Eigen::Index node = 0; node < side.force.rows(); ++node) {
    const RowVector3d force = side.force.row(node), arm = side.position.row(node) - centre;
    moment += arm.cross(force);
    magnitude += std::sqrt(arm.squaredNorm() * force.squaredNorm());
  }
  return {moment.transpose(), magnitude};
}

Sum total_work(const InterfaceSide& side) {
  double work = 0, magnitude = 0;
  for (Eigen::Index node = 0; node < side.force.rows(); ++node) {
    work += side.force.row(node).dot(side.motion.row(node));
    magnitude += std::sqrt(side.force.row(node).squaredNorm() * side.motion.row(node).squaredNorm());
  }
  return {Eigen::VectorXd::Constant(1, work), magnitude};
}

bool is_vector_field(const surface::NodeArray& field, const surface::NodeArray& force) {
  return field.rows() == force.rows() && field.cols() == 3 && force.cols() == 3;
}

}  // namespace

ConservationError compare_sides(const InterfaceSide& flow, const InterfaceSide& solid) {
  ConservationError error;
  error.force = relative_difference(total_force(flow), total_force(solid));
  if (is_vector_field(flow.position, flow.force) && is_vector_field(solid.position, solid.force)) {
    const RowVector3d centre = solid.position.colwise().mean();
    error.moment = relative_difference(total_moment(flow, centre), total_moment(solid, centre));
  }
  const auto has_work = [](const InterfaceSide& side) {
    return side.motion.rows() == side.force.rows() && side.motion.cols() == side.force.cols();
  };
  if (has_work(flow) && has_work(solid)) error.work = relative_difference(total_work(flow), total_work(solid));
  return error;
}

}  // namespace couplet::coupling
