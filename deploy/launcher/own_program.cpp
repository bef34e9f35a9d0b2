#include "deploy/launcher/own_program.hpp"

#include <unistd.h>
#include <wordexp.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

namespace fs = std::filesystem;

/// Where a program lies that is named without a folder; empty: nowhere.
fs::path find_in_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder) / name;
    if (access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate)) return candidate;
  }
  return {};
}

void refuse_unless_it_can_start(const std::string& option, const std::string& command, const std::string& program) {
  const std::string where = option + " \"" + command + "\"";
  const fs::path path = program.find('/') == std::string::npos ? find_in_path(program) : fs::path(program);
  std::error_code ignored;
  if (path.empty() || !fs::exists(path, ignored)) {
    throw report::SceneError(where, "there is no program " + program,
                             "give its path, for example ./" + fs::path(program).filename().string());
  }
  if (fs::is_directory(path, ignored) || access(path.c_str(), X_OK) != 0) {
    throw report::SceneError(
        where, program + " cannot be started",
        "make it executable with chmod +x, or name its interpreter, for example python3 " + program);
  }
}

}  // namespace

std::vector<std::string> split_command(const std::string& option, const std::string& command) {
  wordexp_t found{};
  const int fault = wordexp(command.c_str(), &found, WRDE_NOCMD | WRDE_UNDEF);
  std::vector<std::string> words;
  if (fault == 0) words.assign(found.we_wordv, found.we_wordv + found.we_wordc);
  wordfree(&found);
  const std::string where = option + " \"" + command + "\"";
  if (fault == WRDE_BADVAL) throw report::SceneError(where, "a variable in it has no value", "set it, or quote the $");
  if (fault != 0) {
    throw report::SceneError(where, "is not a program with its options",
                             "close its quotes, and put into a script what only a shell understands");
  }
  if (words.empty()) throw report::SceneError(where, "names no program", "give the program and its options in quotes");
  refuse_unless_it_can_start(option, command, words.front());
  return words;
}

std::map<std::string, std::string> own_program_environment(const Installation& installation) {
  const char* before = std::getenv("PYTHONPATH");
  const std::string folder = (installation.sources / "deploy" / "participant").string();
  return {{"PYTHONPATH", before == nullptr || *before == '\0' ? folder : folder + ":" + before}};
}

}  // namespace couplet::launcher
