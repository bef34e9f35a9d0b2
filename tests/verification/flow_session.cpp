// A coupler's side of a session with a flow server, without a coupler: opens a scene, takes three steps, writes a
// checkpoint, closes. Prints the numbers of each step.
//
//   flow-session SCENE zmq ADDRESS CHECKPOINT
//   mpirun -n 1 flow-session SCENE mpi CHECKPOINT : -n N flow-server serve --transport mpi

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/participant/remote_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/wire/mpi_job.hpp"
#include "proto/wire/zeromq_channel.hpp"

namespace couplet {
namespace {

void hold_session(std::unique_ptr<wire::Channel> channel, const std::string& scene, const std::string& checkpoint) {
  participant::RemoteParticipant flow(std::move(channel), {"flow", "test"});
  participant::OpenRequest request;
  request.scene = scene::load_scene(scene, {}).scene;
  request.scene_folder = std::filesystem::absolute(scene).parent_path().string();
  flow.open(request);
  const double step = request.scene.time().step();
  for (int n = 1; n <= 3; ++n) {
    flow.solve_step({n, 1, (n - 1) * step, step}, {});
    for (const auto& number : flow.accept_step(n)) std::printf("%d %s %.17g\n", n, number.name.c_str(), number.value);
  }
  flow.write_checkpoint(checkpoint);
  for (const auto& number : flow.close("finished"))
    if (number.name == "ranks") std::printf("ranks %.0f\n", number.value);
}

int run(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.at(1) == "zmq") {
    hold_session(wire::connect_zeromq(words.at(2), {}), words.at(0), words.at(3));
    return 0;
  }
  return wire::run_in_mpi("flow-session", [&](wire::MpiJob& job) {
    wire::MpiConnections connections = job.connect(wire::MpiRole::coupler, {});
    hold_session(std::move(connections.flow), words.at(0), words.at(2));
    return 0;
  });
}

}  // namespace
}  // namespace couplet

int main(int argc, char** argv) {
  return couplet::report::run_program("flow-session", couplet::run, argc, argv);
}
