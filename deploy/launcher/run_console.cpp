#include "deploy/launcher/run_console.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "proto/report/failure.hpp"

namespace couplet::launcher {

RunConsole::RunConsole(const std::filesystem::path& log, bool quiet)
    // Appending: the coupler writes its own lines to the same file.
    : log_(log, std::ios::app), quiet_(quiet), is_terminal_(isatty(STDERR_FILENO) == 1) {
  if (!log_) throw report::FileError(log.string(), "cannot be written", "choose another folder with --out");
}

RunConsole::~RunConsole() {
  end_update();
}

void RunConsole::log(const std::string& program, const std::string& line) {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::tm local{};
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", localtime_r(&now, &local));
  log_ << text << ' ' << program << ' ' << line << std::endl;
}

void RunConsole::note(const std::string& line) {
  log("couplet", line);
  show("  " + line);
}

void RunConsole::show(const std::string& line) {
  if (quiet_) return;
  end_update();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void RunConsole::update(const std::string& line) {
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  if (is_terminal_) {
    const std::size_t n_blanks = open_update_ > line.size() ? open_update_ - line.size() : 0;
    std::fprintf(stderr, "\r%s%s", line.c_str(), std::string(n_blanks, ' ').c_str());
    open_update_ = std::max(line.size(), std::size_t{1});
  } else if (now - last_update_ > std::chrono::seconds(10)) {
    std::fprintf(stderr, "%s\n", line.c_str());
    last_update_ = now;
  }
}

void RunConsole::end_update() {
  if (open_update_ > 0) std::fprintf(stderr, "\n");
  open_update_ = 0;
}

}  // namespace couplet::launcher
