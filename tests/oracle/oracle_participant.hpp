#pragma once
// What all participants with known answers share: an accepted and a trial state that fit in a few columns.

#include <string>
#include <utility>
#include <vector>

#include "proto/participant/participant.hpp"
#include "proto/store/hdf5_file.hpp"

namespace couplet::oracle {

/// A participant that only has to say how its state follows from the last one. `State` has columns(), an array
/// (n_nodes, m), and from_columns(), its inverse.
template <class State>
class OracleParticipant : public participant::Participant {
 public:
  explicit OracleParticipant(State start) : accepted_(std::move(start)) {}

  participant::Opened open(const participant::OpenRequest& request) override {
    if (!request.resume_from.empty()) {
      const store::Hdf5File file = store::Hdf5File::open_for_reading(request.resume_from);
      accepted_ = State::from_columns(file.read("state"));
      time_ = file.read_number("time");
    }
    participant::Opened opened;
    opened.surface = nodes();
    opened.time = time_;
    opened.needs = needs();
    opened.fields = offered(accepted_);
    for (const auto& field : opened.fields) opened.offers.push_back(field.name);
    return opened;
  }

  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    trial_ = solve(accepted_, interval, fields);
    trial_time_ = interval.start + interval.duration;
    participant::StepSolved solved;
    solved.fields = offered(trial_);
    return solved;
  }

  std::vector<participant::NamedNumber> accept_step(std::int64_t) override {
    accepted_ = trial_;
    time_ = trial_time_;
    return {quantity(accepted_)};
  }

  std::uint64_t write_checkpoint(const std::string& path) override {
    store::Hdf5File file = store::Hdf5File::create(path);
    file.write("state", accepted_.columns());
    file.write_number("time", time_);
    file.close();
    return std::filesystem::file_size(path);
  }

  std::vector<participant::NamedNumber> close(const std::string&) override {
    return {{"seconds", 0, "s"}, {"peak_memory_bytes", 0, "1"}};
  }

 private:
  virtual surface::SurfaceMesh nodes() const = 0;
  virtual std::vector<std::string> needs() const = 0;
  virtual surface::FieldSet offered(const State& state) const = 0;
  virtual State solve(const State& accepted, const participant::StepInterval& interval,
                      const surface::FieldSet& fields) const = 0;
  virtual participant::NamedNumber quantity(const State& accepted) const = 0;

  double time_ = 0, trial_time_ = 0;
  State accepted_, trial_;
};

/// n nodes in a row along x, from 0 to `length`.
inline surface::SurfaceMesh row_of_nodes(Eigen::Index n, double length) {
  surface::SurfaceMesh mesh;
  mesh.node_position = surface::NodeArray::Zero(n, 3);
  mesh.node_position.col(0) = Eigen::VectorXd::LinSpaced(n, 0, length);
  return mesh;
}

}  // namespace couplet::oracle
