#pragma once
// Calls to the participant of rank 0, carried to the same participant on the other ranks.

#include <mpi.h>

#include <memory>

#include "proto/participant/participant.hpp"

namespace couplet::flow {

/// On rank 0: every call is told to the other ranks, which execute it at the same time on their own participants; rank
/// 0 returns what its own answers. When the call fails on any rank it fails here with that failure, and the other ranks
/// know. A rank that has failed while others wait for it inside the call ends the job, after its patience, with the
/// exit code of its failure.
class RelayedParticipant : public participant::Participant {
 public:
  /// Collective together with follow_calls(). `own` is that of rank 0; the communicator is duplicated.
  RelayedParticipant(std::unique_ptr<participant::Participant> own, MPI_Comm ranks);
  /// Lets the other ranks go.
  ~RelayedParticipant() override;
  RelayedParticipant(const RelayedParticipant&) = delete;
  RelayedParticipant& operator=(const RelayedParticipant&) = delete;

  participant::Opened open(const participant::OpenRequest& request) override;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override;
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<participant::NamedNumber> close(const std::string& reason) override;

 private:
  std::unique_ptr<participant::Participant> own_;
  MPI_Comm relay_ = MPI_COMM_NULL;
};

/// On the other ranks: executes the calls that rank 0 gets until it lets them go. Waits without using its core.
void follow_calls(participant::Participant& participant, MPI_Comm ranks);

}  // namespace couplet::flow
