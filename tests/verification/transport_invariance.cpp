// The same coupled run over memory, ZeroMQ and MPI, with one thread and two, and after a restart: equal bits.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "coupler/scheme/coupled_run.hpp"
#include "flow-server/service/flow_participant.hpp"
#include "proto/participant/remote_participant.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/participant/server_program.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/wire/memory_channel.hpp"
#include "solid-server/service/solid_participant.hpp"

namespace couplet {
namespace {

namespace fs = std::filesystem;

const std::string scene_file = SCENE_FILE, program = COUPLET_PROGRAM;

// The glottis opens under its rising pressure: enough for iterations, prediction and history to matter.
const std::vector<std::string> settings = {"time.end=1.2e-3", "output.results_start=0", "output.results_interval=5e-4",
                                           "output.quantity=[]", "output.checkpoints.every_steps=30"};

class TransportInvariance : public testing::Test {
 protected:
  TransportInvariance() {
    std::string pattern = (fs::temp_directory_path() / "couplet-transport-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~TransportInvariance() override { fs::remove_all(folder_); }

  static std::string history(const fs::path& run) {
    std::ostringstream text;
    text << std::ifstream(run / "history.csv").rdbuf();
    return text.str();
  }

  /// The three programs, started by the launcher.
  std::string with_programs(const std::string& name, const std::string& arguments) const {
    std::string command = program + " run " + scene_file + " --quiet --no-report --out " + (folder_ / name).string();
    for (const std::string& setting : settings) command += " --set '" + setting + "'";
    command += " " + arguments + " > " + (folder_ / (name + ".txt")).string() + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return history(folder_ / name);
  }

  /// Coupler, flow and solid in this process, with the session between them.
  std::string in_memory() const {
    const scene::SceneFile file = scene::load_scene(scene_file, settings);
    auto flow = wire::make_memory_channel(), solid = wire::make_memory_channel();
    const auto serve = [](wire::Channel& channel, participant::Participant& participant) {
      participant::ServeOptions options;
      options.program = "server";
      participant::serve_participant(channel, participant, options);
    };
    flow::FlowParticipant flow_participant;
    solid::SolidParticipant solid_participant(participant::ServerOptions{1});
    std::thread flow_thread([&] { serve(*flow.second, flow_participant); });
    std::thread solid_thread([&] { serve(*solid.second, solid_participant); });
    {
      participant::RemoteParticipant remote_flow(std::move(flow.first), {.name = "flow", .run = "memory"});
      participant::RemoteParticipant remote_solid(std::move(solid.first), {.name = "solid", .run = "memory"});
      coupling::CoupledRunOptions options;
      options.scene_path = scene_file;
      options.scene_folder = fs::absolute(file.folder).string();
      options.run_folder = folder_ / "memory";
      options.quiet = true;
      coupling::run_coupled(remote_flow, remote_solid, file.scene, options);
    }
    flow_thread.join();
    solid_thread.join();
    return history(folder_ / "memory");
  }

  fs::path folder_;
};

TEST_F(TransportInvariance, MemoryZeromqAndMpiGiveEqualBits) {
  const std::string memory = in_memory();
  EXPECT_GT(memory.size(), 10000u);
  EXPECT_EQ(memory, with_programs("zmq", "--transport zmq --solid-threads 1"));
  EXPECT_EQ(memory, with_programs("mpi", "--transport mpi --solid-threads 1"));
}

TEST_F(TransportInvariance, TwoThreadsGiveTheBitsOfOne) {
  EXPECT_EQ(with_programs("one", "--solid-threads 1"), with_programs("two", "--solid-threads 2"));
}

TEST_F(TransportInvariance, ARestartGivesTheBitsOfARunThatWasNeverStopped) {
  const std::string whole = with_programs("whole", "");
  with_programs("halves", "--steps 40");
  EXPECT_EQ(whole, with_programs("halves", "--resume " + (folder_ / "halves").string()));
}

}  // namespace
}  // namespace couplet
