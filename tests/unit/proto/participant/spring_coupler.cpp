// The coupler's part in the tests of MPI jobs: drives every server that the job has. The argument says what happens:
//   finish    ten steps and a close
//   slow      the same, with a step of a second
//   tear      a step that fails
//   vanish    loses its senses without a farewell (exit code 4)
//   freeze    stops for good
//   alone     says that it is a coupler and finds no server

#include <signal.h>

#include <cstdio>

#include "proto/participant/remote_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/wire/mpi_job.hpp"

namespace {

using namespace couplet;
using participant::RemoteParticipant;

surface::FieldSet force() {
  return {{"force", "N", surface::NodeArray::Ones(2, 3)}};
}

void play(const std::string& part, RemoteParticipant& remote) {
  remote.open({});
  if (part == "vanish") throw report::PeerError("coupler", "has lost its senses");
  if (part == "freeze") raise(SIGSTOP);
  try {
    for (int step = 1; step <= 10; ++step) {
      const int iteration = part == "tear" ? 99 : part == "slow" && step == 5 ? 98 : 1;
      remote.solve_step({step, iteration, 0.1 * step, 0.1}, force());
      remote.accept_step(step);
    }
  } catch (const report::NumericsError&) {
    remote.close("failed");
    throw;
  }
  const double seconds = remote.close("finished").at(0).value;
  std::printf("closed after %g s\n", seconds);
}

}  // namespace

int main(int, char** argv) {
  const std::string part = argv[1];
  return wire::run_in_mpi("coupler", [&](wire::MpiJob& job) {
    auto connections = job.connect(wire::MpiRole::coupler, {0.8});
    for (auto* channel : {&connections.flow, &connections.solid}) {
      if (*channel == nullptr) continue;
      RemoteParticipant remote(std::move(*channel), {channel == &connections.flow ? "flow" : "solid", "run"});
      play(part, remote);
    }
    return 0;
  });
}
