#include "deploy/launcher/hosts.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/shell_words.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/check_scene.hpp"
#include "proto/scene/message_parser.hpp"
#include "proto/scene/read_text.hpp"

namespace couplet::launcher {
namespace {

using Words = std::vector<std::string>;

const std::string host_word = "{host}", command_word = "{command}";

Words shell_words(const v1::Hosts& hosts) {
  std::istringstream text(hosts.remote_shell());
  Words words;
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

/// The remote shell with its two words filled in.
Words remote_command(const std::string& host, const std::string& command, const v1::Hosts& hosts) {
  Words words = shell_words(hosts);
  for (std::string& word : words) {
    if (word == host_word) word = host;
    if (word == command_word) word = command;
  }
  return words;
}

void check_remote_shell(const v1::Hosts& hosts, scene::Review& review) {
  const Words words = shell_words(hosts);
  for (const std::string& needed : {host_word, command_word}) {
    if (std::count(words.begin(), words.end(), needed) == 1) continue;
    review.complain("remote_shell", "has no word " + needed + ", or several; write for example: ssh {host} {command}");
  }
  if (words.empty() || words.front() == host_word || words.front() == command_word)
    review.complain("remote_shell", "starts with no program; write for example: ssh {host} {command}");
}

void check_no_host_twice(const v1::Hosts& hosts, scene::Review& review) {
  std::set<std::string> names;
  for (int i = 0; i < hosts.flow_size(); ++i) {
    if (hosts.flow(i).has_name() && !names.insert(hosts.flow(i).name()).second)
      review.complain("flow[" + std::to_string(i) + "].name", "stands twice; give it once with more slots");
  }
}

}  // namespace

v1::Hosts read_hosts(const std::filesystem::path& path) {
  v1::Hosts hosts;
  scene::ComplaintList complaints(path.string());
  scene::FieldTree tree;
  const std::string text = scene::read_text(path, "give a file of hosts; `couplet describe Hosts` says what is in it");
  const bool braces_match = scene::MessageParser(text, "", complaints).parse_all(hosts, tree);
  scene::Review review(tree, braces_match, complaints);
  scene::check_fields(hosts, path.parent_path(), review);
  check_remote_shell(hosts, review);
  check_no_host_twice(hosts, review);
  std::string lines;
  for (const scene::Complaint& complaint : complaints.in_order())
    lines += (lines.empty() ? "" : "\n") + complaint.text();
  if (!lines.empty()) throw report::SceneError("", lines);
  return hosts;
}

int n_slots(const v1::Hosts& hosts) {
  int n = 0;
  for (const v1::FlowHost& host : hosts.flow()) n += host.slots();
  return n;
}

bool is_this_machine(const std::string& host) {
  std::array<char, 256> own{};
  gethostname(own.data(), own.size() - 1);
  return host == "localhost" || host == own.data();
}

std::string numeric_address(const std::string& host, const std::string& address) {
  const std::string name = address.empty() ? host : address;
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  if (getaddrinfo(name.c_str(), nullptr, &wanted, &found) != 0 || found == nullptr)
    throw report::SceneError("host '" + name + "'", "no address is known for this name",
                             "give its number, for example address: \"10.0.0.5\"");
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in*>(found->ai_addr)->sin_addr, text.data(), text.size());
  freeaddrinfo(found);
  return text.data();
}

ProgramStart through_remote_shell(const ProgramStart& start, const v1::Hosts& hosts, const std::string& couplet) {
  if (start.host.empty() || is_this_machine(start.host)) return start;
  std::string command = "cd " + quoted(std::filesystem::current_path().string()) + " && exec env";
  for (const auto& [name, value] : start.environment) command += " " + quoted(name + "=" + value);
  command += " " + quoted(couplet) + " attend";
  for (const std::string& word : start.command) command += " " + quoted(word);
  ProgramStart there = start;
  there.command = remote_command(start.host, command, hosts);
  there.environment.clear();
  there.is_attended = true;
  return there;
}

std::string mpi_agent(const v1::Hosts& hosts) {
  const Words words = shell_words(hosts);
  if (words.size() < 3 || words[words.size() - 2] != host_word || words.back() != command_word) return {};
  std::string agent;
  for (std::size_t i = 0; i + 2 < words.size(); ++i) agent += (i > 0 ? " " : "") + words[i];
  return agent;
}

bool answers(const std::string& host, const v1::Hosts& hosts) {
  if (is_this_machine(host)) return true;
  Words words{"timeout", "10"};
  for (const std::string& word : remote_command(host, "true", hosts)) words.push_back(word);
  return run_and_catch(words).exit_code == 0;
}

v1::Hosts replace_lost(v1::Hosts hosts, const std::function<bool(const std::string&)>& answers,
                       const std::function<void(const std::string&)>& tell) {
  std::map<std::string, bool> known;
  const auto lives = [&](const std::string& host) {
    const auto found = known.find(host);
    return found != known.end() ? found->second : (known[host] = answers(host));
  };
  std::map<std::string, v1::SpareHost> successors;  // one for all that ran on a host
  const auto mend = [&](auto& place) {
    if (lives(place.name())) return;
    if (successors.count(place.name()) == 0) {
      while (hosts.spare_size() > 0 && !lives(hosts.spare(0).name())) hosts.mutable_spare()->DeleteSubrange(0, 1);
      if (hosts.spare_size() == 0)
        throw report::PeerError("host '" + place.name() + "'", "cannot be reached any more, and no spare host is left",
                                "mend it, or add a spare host and continue with --resume");
      tell("host '" + place.name() + "' cannot be reached any more; '" + hosts.spare(0).name() + "' takes its place");
      successors[place.name()] = hosts.spare(0);
      hosts.mutable_spare()->DeleteSubrange(0, 1);
    }
    const v1::SpareHost& successor = successors.at(place.name());
    place.set_name(successor.name());
    if constexpr (requires { place.clear_address(); }) {
      place.clear_address();
      if (successor.has_address()) place.set_address(successor.address());
    }
  };
  for (v1::FlowHost& host : *hosts.mutable_flow()) mend(host);
  mend(*hosts.mutable_solid());
  mend(*hosts.mutable_coupler());
  return hosts;
}

}  // namespace couplet::launcher
