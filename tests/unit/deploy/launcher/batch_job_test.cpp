#include "deploy/launcher/batch_job.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/hosts.hpp"
#include "proto/store/run_folder.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(BatchJob, QuotesEveryWordForTheShell) {
  BatchOptions options;
  options.run.scene = "/my scenes/scene.txtpb";
  options.run.out = "/runs/it's mine";
  options.run.settings = {"title=a $b `c`"};
  const std::filesystem::path programs = std::filesystem::path(testing::TempDir()) / "batch_job_programs";
  std::filesystem::create_directories(programs / "couplet");
  const std::string text = batch_job_text(options, true, {programs, "/sources", "python3"});
  EXPECT_THAT(text, Not(HasSubstr("--hosts")));
  EXPECT_THAT(text, HasSubstr("'/my scenes/scene.txtpb'"));
  EXPECT_THAT(text, HasSubstr("'/runs/it'\\''s mine'"));
  EXPECT_THAT(text, HasSubstr("'title=a $b `c`'"));
}

/// What the lines of a job write when it runs on these nodes.
std::string hosts_of_job(const BatchOptions& options, bool has_solid, const std::string& nodes) {
  const store::TemporaryFolder folder;
  BatchOptions here = options;
  here.run.out = folder / "run";
  std::filesystem::create_directories(folder / "bin" / "couplet");
  std::filesystem::create_directories(folder / "run" / "keys");  // a second job finds those of the first
  store::write_file(folder / "bin" / "scontrol", "#!/bin/sh\nprintf '%s\\n' " + nodes + "\n");
  std::filesystem::permissions(folder / "bin" / "scontrol", std::filesystem::perms::owner_all);
  std::string text = batch_job_text(here, has_solid, {folder / "bin", "/sources", "python3"});
  text.replace(text.find("exec "), 5, "echo ");
  store::write_file(folder / "job.sh", text);
  const ProgramResult result = run_and_catch(
      {"env", "PATH=" + (folder / "bin").string() + ":/usr/bin:/bin", "bash", (folder / "job.sh").string()});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("--hosts " + (folder / "run" / "hosts.txtpb").string() + " --keys "));
  read_hosts(folder / "run" / "hosts.txtpb");
  return store::text_of(folder / "run" / "hosts.txtpb");
}

TEST(BatchJob, OnSeveralNodesWritesTheFileOfHosts) {
  BatchOptions options;
  options.run.scene = "/scene.txtpb";
  options.nodes = 3;
  options.cpus = 8;
  options.network = "10.0.0.0/24";
  EXPECT_EQ(hosts_of_job(options, true, "n1 n2 n3"),
            "flow { name: \"n1\"  slots: 8 }\nflow { name: \"n2\"  slots: 8 }\n"
            "solid { name: \"n3\"  threads: 8 }\ncoupler { name: \"n3\" }\n"
            "remote_shell: \"srun --overlap --nodes=1 --ntasks=1 -w {host} bash -c {command}\"\n"
            "network: \"10.0.0.0/24\"\n");
  options.network.clear();
  EXPECT_THAT(hosts_of_job(options, false, "n1 n2 n3"), HasSubstr("flow { name: \"n3\"  slots: 8 }"));
}

}  // namespace
}  // namespace couplet::launcher
