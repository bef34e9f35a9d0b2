#include "deploy/launcher/check_participant.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/own_program.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/read_scene.hpp"

namespace couplet::launcher {
namespace {

/// From now on a text is what this program, and what it becomes, reads from its standard input.
void put_into_standard_input(const std::string& text) {
  std::FILE* file = std::tmpfile();  // has no name, so nobody need remove it
  const bool is_written = file != nullptr && std::fputs(text.c_str(), file) >= 0 && std::fflush(file) == 0;
  if (!is_written || std::fseek(file, 0, SEEK_SET) != 0 || dup2(fileno(file), STDIN_FILENO) < 0) {
    throw report::FileError("a temporary file", std::strerror(errno), "make room in the folder for temporary files");
  }
}

}  // namespace

void check_participant(const ParticipantCheckOptions& options) {
  const Installation installation = find_installation();
  const std::vector<std::string> command = split_command("check-participant", options.command);
  const std::filesystem::path scene =
      options.scene.empty() ? std::filesystem::path(installation.script("deploy/participant/check_scene.txtpb"))
                            : options.scene;
  put_into_standard_input(scene::resolved_scene_text(read_checked_scene(scene, options.settings).scene));
  std::vector<std::string> words{installation.python, installation.script("deploy/participant/check_participant.py"),
                                 "--scene",           "-",
                                 "--scene-file",      scene.string(),
                                 "--solid-server",    installation.program("solid-server")};
  for (const std::string& rule : options.rules) words.insert(words.end(), {"--rule", rule});
  words.emplace_back("--");
  words.insert(words.end(), command.begin(), command.end());
  become_program(words);
}

}  // namespace couplet::launcher
