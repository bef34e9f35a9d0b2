#include "deploy/launcher/hosts.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "deploy/launcher/external_program.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::launcher {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string three = R"(
flow { name: "a"  slots: 16  address: "10.0.0.1" }
flow { name: "b" }
solid { name: "c"  threads: 8 }
coupler { name: "c" }
)";

v1::Hosts read(const std::string& text) {
  const store::TemporaryFolder folder;
  store::write_file(folder / "hosts.txtpb", text);
  return read_hosts(folder / "hosts.txtpb");
}

std::string complaints_about(const std::string& text) {
  try {
    read(text);
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "none";
}

TEST(Hosts, SayWhoRunsWhere) {
  const v1::Hosts hosts = read(three);
  EXPECT_EQ(hosts.flow(0).slots(), 16);
  EXPECT_EQ(n_slots(hosts), 17);
  EXPECT_EQ(hosts.solid().threads(), 8);
  EXPECT_EQ(mpi_agent(hosts), "ssh -o BatchMode=yes");
}

TEST(Hosts, AreCheckedAsScenesAre) {
  EXPECT_THAT(complaints_about("flow { name: \"a\" }"), HasSubstr("hosts.txtpb:1:1: solid"));
  EXPECT_THAT(complaints_about(three + "flow { name: \"d\"  slots: 0 }"), HasSubstr("hosts.txtpb:6:"));
  EXPECT_THAT(complaints_about(three + "flow { name: \"a\" }"), HasSubstr("flow[2].name: stands twice"));
  EXPECT_THAT(complaints_about(three + "remote_shell: \"ssh {host}\""), HasSubstr("has no word {command}"));
  EXPECT_THAT(complaints_about(three + "remote_shell: \"{host} {command}\""), HasSubstr("starts with no program"));
  EXPECT_THAT(complaints_about(three + "hosts: 3"), HasSubstr("hosts"));
  EXPECT_THROW(read_hosts("/nowhere/hosts.txtpb"), report::FileError);
}

TEST(Hosts, AreReachedByTheRemoteShell) {
  v1::Hosts hosts = read(three);
  hosts.set_remote_shell("srun -w {host} bash -c {command}");
  EXPECT_EQ(mpi_agent(hosts), "") << "Open MPI could not use it";
  ProgramStart start{"solid-server", {"/bin/solid server", "it's"}, {{"A", "1 2"}}, "--solid", {}};
  start.host = "c";
  const ProgramStart there = through_remote_shell(start, hosts, "/bin/couplet");
  ASSERT_EQ(there.command.size(), 6U);
  EXPECT_EQ(std::vector(there.command.begin(), there.command.end() - 1),
            (std::vector<std::string>{"srun", "-w", "c", "bash", "-c"}));
  EXPECT_EQ(there.command.back(), "cd '" + std::filesystem::current_path().string() +
                                      "' && exec env 'A=1 2' '/bin/couplet' attend '/bin/solid server' 'it'\\''s'");
  EXPECT_TRUE(there.is_attended);
  EXPECT_THAT(there.environment, IsEmpty());
  EXPECT_EQ(there.address_option, "--solid");
}

TEST(Hosts, NeedNoRemoteShellOnThisMachine) {
  std::array<char, 256> own{};
  gethostname(own.data(), own.size() - 1);
  for (const std::string& name : {std::string("localhost"), std::string(own.data())}) {
    ProgramStart start{"coupler", {"coupler", "run"}, {}, {}, {}};
    start.host = name;
    EXPECT_EQ(through_remote_shell(start, read(three), "couplet").command, start.command);
    EXPECT_TRUE(answers(name, read(three)));
  }
}

TEST(Hosts, AnswerWhenACommandCanBeStartedThere) {
  v1::Hosts hosts = read(three);
  hosts.set_remote_shell("env -u {host} sh -c {command}");
  EXPECT_TRUE(answers("a", hosts));
  hosts.set_remote_shell("false {host} {command}");
  EXPECT_FALSE(answers("a", hosts));
}

TEST(Hosts, HaveNumbers) {
  EXPECT_EQ(numeric_address("localhost", ""), "127.0.0.1");
  EXPECT_EQ(numeric_address("node", "10.1.2.3"), "10.1.2.3");
  EXPECT_THROW(numeric_address("no-such-host.invalid", ""), report::SceneError);
}

struct Replacement {
  v1::Hosts hosts;
  std::vector<std::string> told;
};

Replacement replace(const std::string& text, const std::vector<std::string>& lost) {
  Replacement result;
  result.hosts = replace_lost(
      read(text), [&](const std::string& host) { return std::find(lost.begin(), lost.end(), host) == lost.end(); },
      [&](const std::string& sentence) { result.told.push_back(sentence); });
  return result;
}

TEST(LostHosts, AreReplacedBySpareOnesThatAnswer) {
  const std::string text =
      three + "spare { name: \"d\" } spare { name: \"e\"  address: \"10.0.0.9\" } spare { name: \"f\" }";
  EXPECT_THAT(replace(text, {}).told, IsEmpty());
  const Replacement found = replace(text, {"c", "d"});
  EXPECT_EQ(found.hosts.solid().name(), "e");
  EXPECT_EQ(found.hosts.solid().address(), "10.0.0.9");
  EXPECT_EQ(found.hosts.solid().threads(), 8);
  EXPECT_EQ(found.hosts.coupler().name(), "e") << "one successor for all that ran on a host";
  EXPECT_EQ(found.hosts.spare_size(), 1);
  EXPECT_THAT(found.told, ElementsAre("host 'c' cannot be reached any more; 'e' takes its place"));
  const Replacement flow = replace(text, {"a"});
  EXPECT_EQ(flow.hosts.flow(0).name(), "d");
  EXPECT_EQ(flow.hosts.flow(0).slots(), 16);
  EXPECT_FALSE(flow.hosts.flow(0).has_address()) << "that of the lost one";
}

TEST(LostHosts, EndTheRunWhenThereAreNoSpareOnes) {
  EXPECT_THROW(replace(three, {"b"}), report::PeerError);
  EXPECT_THROW(replace(three + "spare { name: \"d\" }", {"a", "b"}), report::PeerError);
}

}  // namespace
}  // namespace couplet::launcher
