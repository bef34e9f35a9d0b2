#include "tests/oracle/elastic_tube_participants.hpp"

#include <utility>

#include "proto/store/hdf5_file.hpp"

namespace couplet::oracle {

namespace {

using Eigen::VectorXd;
using participant::Opened;
using surface::NodeArray;

surface::SurfaceMesh tube_nodes(const ElasticTube& tube) {
  surface::SurfaceMesh mesh;
  mesh.node_position = NodeArray::Zero(tube.n_cells + 1, 3);
  mesh.node_position.col(0) = VectorXd::LinSpaced(tube.n_cells + 1, 0, tube.length);
  return mesh;
}

}  // namespace

ElasticTubeFlow::ElasticTubeFlow(ElasticTube tube) : tube_(tube), accepted_(rest_state(tube)) {}

Opened ElasticTubeFlow::open(const participant::OpenRequest& request) {
  if (!request.resume_from.empty()) {
    const store::Hdf5File file = store::Hdf5File::open_for_reading(request.resume_from);
    const NodeArray state = file.read("state");
    accepted_ = {state.col(0), state.col(1), state.col(2)};
    time_ = file.read_number("time");
  }
  return {tube_nodes(tube_), time_, {"area"}, {"pressure"}, {{"pressure", "Pa", accepted_.pressure}}};
}

participant::StepSolved ElasticTubeFlow::solve_step(const participant::StepInterval& interval,
                                                    const surface::FieldSet& fields) {
  trial_time_ = interval.start + interval.duration;
  const VectorXd area = surface::find_field(fields, "area").values;
  trial_ = solve_tube_flow(tube_, accepted_, area, trial_time_, interval.duration);
  participant::StepSolved solved;
  solved.fields = {{"pressure", "Pa", trial_.pressure}};
  return solved;
}

std::vector<participant::NamedNumber> ElasticTubeFlow::accept_step(std::int64_t) {
  accepted_ = trial_;
  time_ = trial_time_;
  return {{"inlet_pressure", accepted_.pressure(0), "Pa"}};
}

std::uint64_t ElasticTubeFlow::write_checkpoint(const std::string& path) {
  store::Hdf5File file = store::Hdf5File::create(path);
  NodeArray state(accepted_.pressure.size(), 3);
  state << accepted_.velocity, accepted_.pressure, accepted_.area;
  file.write("state", state);
  file.write_number("time", time_);
  file.close();
  return std::filesystem::file_size(path);
}

std::vector<participant::NamedNumber> ElasticTubeFlow::close(const std::string&) {
  return {{"seconds", 0, "s"}, {"peak_memory_bytes", 0, "1"}};
}

Opened ElasticTubeWall::open(const participant::OpenRequest& request) {
  area_ = rest_state(tube_).area;
  if (!request.resume_from.empty()) {
    const store::Hdf5File file = store::Hdf5File::open_for_reading(request.resume_from);
    area_ = file.read("area");
    time_ = file.read_number("time");
  }
  return {tube_nodes(tube_), time_, {"pressure"}, {"area"}, {{"area", "m^2", area_}}};
}

participant::StepSolved ElasticTubeWall::solve_step(const participant::StepInterval& interval,
                                                    const surface::FieldSet& fields) {
  trial_time_ = interval.start + interval.duration;
  trial_area_ = tube_.wall_area(surface::find_field(fields, "pressure").values);
  participant::StepSolved solved;
  solved.fields = {{"area", "m^2", trial_area_}};
  return solved;
}

std::vector<participant::NamedNumber> ElasticTubeWall::accept_step(std::int64_t) {
  area_ = trial_area_;
  time_ = trial_time_;
  return {{"largest_area", area_.maxCoeff(), "m^2"}};
}

std::uint64_t ElasticTubeWall::write_checkpoint(const std::string& path) {
  store::Hdf5File file = store::Hdf5File::create(path);
  file.write("area", NodeArray(area_));
  file.write_number("time", time_);
  file.close();
  return std::filesystem::file_size(path);
}

std::vector<participant::NamedNumber> ElasticTubeWall::close(const std::string&) {
  return {{"seconds", 0, "s"}, {"peak_memory_bytes", 0, "1"}};
}

}  // namespace couplet::oracle
