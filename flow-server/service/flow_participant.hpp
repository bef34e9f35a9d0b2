#pragma once
// A flow model as the coupler sees it.

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "flow-server/flow_model.hpp"
#include "flow-server/service/result_schedule.hpp"
#include "proto/participant/participant.hpp"

namespace couplet::flow {

/// Translates between the calls of a session and a FlowModel; keeps no physics. The interface is the solid's own
/// surface, so that fields travel node by node.
class FlowParticipant : public participant::Participant {
 public:
  /// One participant on each rank of the communicator, called with equal arguments. MPI_COMM_NULL: a process without
  /// MPI, which can compute one-dimensional flow only.
  explicit FlowParticipant(MPI_Comm ranks = MPI_COMM_NULL) : ranks_(ranks) {}

  participant::Opened open(const participant::OpenRequest& request) override;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override;
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<participant::NamedNumber> close(const std::string& reason) override;

 private:
  bool holds_on_all_ranks(bool holds) const;

  MPI_Comm ranks_;
  std::unique_ptr<FlowModel> model_;
  ResultSchedule schedule_;
  double seconds_ = 0;  // spent in this participant [s]
};

/// The participant of rank 0, whose calls the others follow; on a single rank, or without MPI, simply a participant.
std::unique_ptr<participant::Participant> make_flow_participant(MPI_Comm ranks);
/// What the other ranks do.
void follow_flow_participant(MPI_Comm ranks);

}  // namespace couplet::flow
