#include "deploy/launcher/process_tree.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>

namespace couplet::launcher {
namespace {

/// /proc/PID/stat: pid (name) state parent ...; the name may hold blanks and brackets. Nothing when it has ended.
std::optional<ProcessState> read_state(const std::filesystem::path& folder) {
  std::ifstream file(folder / "stat");
  std::string line;
  if (!std::getline(file, line)) return {};
  const std::size_t open = line.find('('), close = line.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close + 2 >= line.size()) return {};
  const char state = line[close + 2];
  if (state == 'Z' || state == 'X') return {};
  return ProcessState{static_cast<pid_t>(std::stol(line)), line.substr(open + 1, close - open - 1),
                      state == 'T' || state == 't'};
}

/// /proc/PID/task/THREAD/children: what each of its threads has started.
std::vector<pid_t> read_children(const std::filesystem::path& folder) {
  std::vector<pid_t> children;
  std::error_code ignored;  // threads come and go while we look
  for (const auto& thread : std::filesystem::directory_iterator(folder / "task", ignored)) {
    std::ifstream file(thread.path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

void add_tree(pid_t root, std::vector<ProcessState>& tree) {
  const std::filesystem::path folder = "/proc/" + std::to_string(root);
  const auto state = read_state(folder);
  if (!state) return;
  tree.push_back(*state);
  for (const pid_t child : read_children(folder)) add_tree(child, tree);
}

}  // namespace

std::vector<ProcessState> process_tree(pid_t root) {
  std::vector<ProcessState> tree;
  add_tree(root, tree);
  return tree;
}

void signal_tree(pid_t root, int signal) {
  for (const ProcessState& process : process_tree(root)) kill(process.pid, signal);
}

void signal_named(pid_t root, const std::string& name, int signal) {
  for (const ProcessState& process : process_tree(root))
    if (process.name == name) kill(process.pid, signal);
}

}  // namespace couplet::launcher
