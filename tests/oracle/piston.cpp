#include "tests/oracle/piston.hpp"

#include <cmath>
#include <utility>

#include "proto/store/hdf5_file.hpp"

namespace couplet::oracle {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using participant::Opened;
using surface::NodeArray;

NodeArray along_y(const VectorXd& values) {
  NodeArray array = NodeArray::Zero(values.size(), 3);
  array.col(1) = values;
  return array;
}

surface::SurfaceMesh row_of_nodes(Index n) {
  surface::SurfaceMesh mesh;
  mesh.node_position = NodeArray::Zero(n, 3);
  mesh.node_position.col(0) = VectorXd::LinSpaced(n, 0, static_cast<double>(n - 1));
  return mesh;
}

Kinematics start(const PistonRow& row) {
  return {VectorXd::Zero(row.n_nodes()), row.velocity, VectorXd::Zero(row.n_nodes())};
}

std::uint64_t write(const std::string& path, const Kinematics& state, double time) {
  store::Hdf5File file = store::Hdf5File::create(path);
  NodeArray columns(state.displacement.size(), 3);
  columns << state.displacement, state.velocity, state.acceleration;
  file.write("state", columns);
  file.write_number("time", time);
  file.close();
  return std::filesystem::file_size(path);
}

void read(const std::string& path, Kinematics& state, double& time) {
  const store::Hdf5File file = store::Hdf5File::open_for_reading(path);
  const NodeArray columns = file.read("state");
  state = {columns.col(0), columns.col(1), columns.col(2)};
  time = file.read_number("time");
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

PistonFlow::PistonFlow(PistonRow row, TimeRule rule) : row_(std::move(row)), rule_(rule), accepted_(start(row_)) {}

Opened PistonFlow::open(const participant::OpenRequest& request) {
  if (!request.resume_from.empty()) read(request.resume_from, accepted_, time_);
  Opened opened;
  opened.surface = row_of_nodes(row_.n_nodes());
  opened.time = time_;
  opened.needs = {"displacement", "velocity"};
  opened.offers = {"force"};
  opened.fields = {{"force", "N", along_y(-row_.added_mass.cwiseProduct(accepted_.acceleration))}};
  return opened;
}

participant::StepSolved PistonFlow::solve_step(const participant::StepInterval& interval,
                                               const surface::FieldSet& fields) {
  const VectorXd displacement = surface::find_field(fields, "displacement").values.col(1);
  trial_ = move_to(accepted_, displacement, interval.duration, rule_);
  trial_time_ = interval.start + interval.duration;
  participant::StepSolved solved;
  solved.fields = {{"force", "N", along_y(-row_.added_mass.cwiseProduct(trial_.acceleration))}};
  return solved;
}

std::vector<participant::NamedNumber> PistonFlow::accept_step(std::int64_t) {
  accepted_ = trial_;
  time_ = trial_time_;
  return {{"largest_force", row_.added_mass.cwiseProduct(accepted_.acceleration).cwiseAbs().maxCoeff(), "N"}};
}

std::uint64_t PistonFlow::write_checkpoint(const std::string& path) {
  return write(path, accepted_, time_);
}

std::vector<participant::NamedNumber> PistonFlow::close(const std::string&) {
  return {{"seconds", 0, "s"}, {"peak_memory_bytes", 0, "1"}};
}

PistonSolid::PistonSolid(PistonRow row, TimeRule rule) : row_(std::move(row)), rule_(rule), accepted_(start(row_)) {}

Opened PistonSolid::open(const participant::OpenRequest& request) {
  if (!request.resume_from.empty()) read(request.resume_from, accepted_, time_);
  Opened opened;
  opened.surface = row_of_nodes(row_.n_nodes());
  opened.time = time_;
  opened.needs = {"force"};
  opened.offers = {"displacement", "velocity"};
  opened.fields = {{"displacement", "m", along_y(accepted_.displacement)},
                   {"velocity", "m/s", along_y(accepted_.velocity)}};
  return opened;
}

// m (slope x + constant) + k x = f
participant::StepSolved PistonSolid::solve_step(const participant::StepInterval& interval,
                                                const surface::FieldSet& fields) {
  const VectorXd force = surface::find_field(fields, "force").values.col(1);
  const AccelerationLaw law = acceleration_law(accepted_, interval.duration, rule_);
  const VectorXd load = force - row_.solid_mass.cwiseProduct(law.constant);
  const VectorXd displacement = load.cwiseQuotient(law.slope * row_.solid_mass + row_.stiffness);
  trial_ = move_to(accepted_, displacement, interval.duration, rule_);
  trial_time_ = interval.start + interval.duration;
  participant::StepSolved solved;
  solved.fields = {{"displacement", "m", along_y(trial_.displacement)}, {"velocity", "m/s", along_y(trial_.velocity)}};
  return solved;
}

std::vector<participant::NamedNumber> PistonSolid::accept_step(std::int64_t) {
  accepted_ = trial_;
  time_ = trial_time_;
  return {{"energy",
           0.5 * (row_.stiffness.cwiseProduct(accepted_.displacement).dot(accepted_.displacement) +
                  row_.solid_mass.cwiseProduct(accepted_.velocity).dot(accepted_.velocity)),
           "J"}};
}

std::uint64_t PistonSolid::write_checkpoint(const std::string& path) {
  return write(path, accepted_, time_);
}

std::vector<participant::NamedNumber> PistonSolid::close(const std::string&) {
  return {{"seconds", 0, "s"}, {"peak_memory_bytes", 0, "1"}};
}

}  // namespace couplet::oracle
