#include "tests/oracle/piston.hpp"

#include <cmath>
#include <utility>

namespace couplet::oracle {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using participant::NamedNumber;
using participant::StepInterval;
using surface::FieldSet;
using surface::NodeArray;

NodeArray along_y(const VectorXd& values) {
  NodeArray array = NodeArray::Zero(values.size(), 3);
  array.col(1) = values;
  return array;
}

Kinematics start(const PistonRow& row) {
  return {VectorXd::Zero(row.n_nodes()), row.velocity, VectorXd::Zero(row.n_nodes())};
}

// a = slope x + constant, for the rule and the state at the start of the step.
struct AccelerationLaw {
  double slope;
  VectorXd constant;
};

AccelerationLaw acceleration_law(const Kinematics& old, double dt, TimeRule rule) {
  switch (rule) {
    case TimeRule::backward:
      return {1 / (dt * dt), -old.displacement / (dt * dt) - old.velocity / dt};
    case TimeRule::trapezoidal:
      break;
  }
  return {4 / (dt * dt), -4 / (dt * dt) * old.displacement - 4 / dt * old.velocity - old.acceleration};
}

}  // namespace

VectorXd PistonRow::exact_displacement(double time) const {
  const Eigen::ArrayXd frequency = (stiffness.array() / (solid_mass + added_mass).array()).sqrt();
  return velocity.array() / frequency * (frequency * time).sin();
}

PistonRow one_piston(double added_mass) {
  const VectorXd one = VectorXd::Ones(1);
  return {one, added_mass * one, one, one};
}

Kinematics move_to(const Kinematics& old, const VectorXd& displacement, double duration, TimeRule rule) {
  const AccelerationLaw law = acceleration_law(old, duration, rule);
  Kinematics moved;
  moved.displacement = displacement;
  moved.acceleration = law.slope * displacement + law.constant;
  moved.velocity = rule == TimeRule::backward
                       ? VectorXd(old.velocity + duration * moved.acceleration)
                       : VectorXd(old.velocity + duration / 2 * (old.acceleration + moved.acceleration));
  return moved;
}

NodeArray Kinematics::columns() const {
  NodeArray columns(displacement.size(), 3);
  columns << displacement, velocity, acceleration;
  return columns;
}

Kinematics Kinematics::from_columns(const NodeArray& columns) {
  return {columns.col(0), columns.col(1), columns.col(2)};
}

PistonFlow::PistonFlow(PistonRow row, TimeRule rule)
    : OracleParticipant(start(row)), row_(std::move(row)), rule_(rule) {}

surface::SurfaceMesh PistonFlow::nodes() const {
  return row_of_nodes(row_.n_nodes(), static_cast<double>(row_.n_nodes() - 1));
}

FieldSet PistonFlow::offered(const Kinematics& state) const {
  return {{"force", "N", along_y(-row_.added_mass.cwiseProduct(state.acceleration))}};
}

Kinematics PistonFlow::solve(const Kinematics& accepted, const StepInterval& interval, const FieldSet& fields) const {
  return move_to(accepted, surface::find_field(fields, "displacement").values.col(1), interval.duration, rule_);
}

NamedNumber PistonFlow::quantity(const Kinematics& accepted) const {
  return {"largest_force", row_.added_mass.cwiseProduct(accepted.acceleration).cwiseAbs().maxCoeff(), "N"};
}

PistonSolid::PistonSolid(PistonRow row, TimeRule rule)
    : OracleParticipant(start(row)), row_(std::move(row)), rule_(rule) {}

surface::SurfaceMesh PistonSolid::nodes() const {
  return row_of_nodes(row_.n_nodes(), static_cast<double>(row_.n_nodes() - 1));
}

FieldSet PistonSolid::offered(const Kinematics& state) const {
  return {{"displacement", "m", along_y(state.displacement)}, {"velocity", "m/s", along_y(state.velocity)}};
}

// m (slope x + constant) + k x = f
Kinematics PistonSolid::solve(const Kinematics& accepted, const StepInterval& interval, const FieldSet& fields) const {
  const VectorXd force = surface::find_field(fields, "force").values.col(1);
  const AccelerationLaw law = acceleration_law(accepted, interval.duration, rule_);
  const VectorXd load = force - row_.solid_mass.cwiseProduct(law.constant);
  const VectorXd displacement = load.cwiseQuotient(law.slope * row_.solid_mass + row_.stiffness);
  return move_to(accepted, displacement, interval.duration, rule_);
}

NamedNumber PistonSolid::quantity(const Kinematics& accepted) const {
  return {"energy",
          0.5 * (row_.stiffness.cwiseProduct(accepted.displacement).dot(accepted.displacement) +
                 row_.solid_mass.cwiseProduct(accepted.velocity).dot(accepted.velocity)),
          "J"};
}

}  // namespace couplet::oracle
