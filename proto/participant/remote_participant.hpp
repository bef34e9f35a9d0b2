#pragma once
// A participant at the other end of a channel.

#include <memory>
#include <string>

#include "proto/participant/participant.hpp"
#include "proto/wire/channel.hpp"

namespace couplet::participant {

struct RemoteOptions {
  std::string name;             // "flow" or "solid", for messages to people
  std::string run;              // name of the run, for Hello
  double hello_deadline = 60;   // [s] the same for the very first request, which needs no computation
  double reply_deadline = 600;  // [s] a request that is not answered by then loses the peer
  double repeat_interval =
      60;  // [s] a request that is not answered yet is sent again, with its number, after this time
};

/// Sends each call as a request, waits for its reply. Failure replies are thrown as the report::Failure they describe;
/// PeerError when the other end is lost, is late, or does not keep to the protocol.
/// start_step and finish_step split solve_step (and their likes accept_step), so that two participants can work at the
/// same time. A session that was
/// not closed is closed by the destructor as well as it can be, so that the server ends orderly when the coupler fails.
class RemoteParticipant : public Participant {
 public:
  RemoteParticipant(std::unique_ptr<wire::Channel> channel, RemoteOptions options);
  ~RemoteParticipant() override;

  Opened open(const OpenRequest& request) override;
  StepSolved solve_step(const StepInterval& interval, const surface::FieldSet& fields) override;
  void start_step(const StepInterval& interval, const surface::FieldSet& fields) override;
  StepSolved finish_step() override;
  std::vector<NamedNumber> accept_step(std::int64_t step) override;
  void start_accept(std::int64_t step) override;
  std::vector<NamedNumber> finish_accept() override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<NamedNumber> close(const std::string& reason) override;

 private:
  struct Session;
  std::unique_ptr<Session> session_;
};

}  // namespace couplet::participant
