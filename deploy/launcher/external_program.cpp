#include "deploy/launcher/external_program.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "deploy/launcher/child_process.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {

ProgramResult run_and_catch(const std::vector<std::string>& command) {
  ChildProcess process({command.front(), command, {}, {}, {}}, {});
  ProgramResult result;
  const auto take = [](const std::vector<OutputLine>& lines, std::string& text) {
    for (const OutputLine& line : lines) text += line.text + "\n";
  };
  while (process.output() >= 0 || process.errors() >= 0) {
    pollfd files[] = {{process.output(), POLLIN, 0}, {process.errors(), POLLIN, 0}};  // poll leaves out negative ones
    poll(files, 2, -1);
    take(process.read_output(), result.output);
    take(process.read_errors(), result.errors);
  }
  while (process.is_running()) {
    process.look();
    if (process.is_running()) usleep(1000);
  }
  result.exit_code = process.ending()->by_signal ? 128 + process.ending()->code : process.ending()->code;
  return result;
}

void become_program(const std::vector<std::string>& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  std::fflush(nullptr);
  execvp(words[0], words.data());
  throw report::FileError(command.front(), std::strerror(errno), "run deploy/setup.sh");
}

}  // namespace couplet::launcher
