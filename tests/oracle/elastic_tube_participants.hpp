#pragma once
// The elastic tube's flow and wall as two participants that exchange area and pressure.

#include "proto/participant/participant.hpp"
#include "tests/oracle/elastic_tube.hpp"

namespace couplet::oracle {

/// The flow as a participant: takes `area`, gives `pressure`, both (n_nodes, 1).
class ElasticTubeFlow : public participant::Participant {
 public:
  explicit ElasticTubeFlow(ElasticTube tube);
  participant::Opened open(const participant::OpenRequest& request) override;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override;
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<participant::NamedNumber> close(const std::string& reason) override;

 private:
  ElasticTube tube_;
  double time_ = 0, trial_time_ = 0;
  TubeFlowState accepted_, trial_;
};

/// The wall as a participant: takes `pressure`, gives `area`; it has no inertia and no memory.
class ElasticTubeWall : public participant::Participant {
 public:
  explicit ElasticTubeWall(ElasticTube tube) : tube_(tube) {}
  participant::Opened open(const participant::OpenRequest& request) override;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override;
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<participant::NamedNumber> close(const std::string& reason) override;

 private:
  ElasticTube tube_;
  double time_ = 0, trial_time_ = 0;
  Eigen::VectorXd area_, trial_area_;
};

}  // namespace couplet::oracle
