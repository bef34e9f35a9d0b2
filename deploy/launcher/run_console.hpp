#pragma once
// What a run says: everything to log.txt, what the user wants to see to the terminal.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

namespace couplet::launcher {

class RunConsole {
 public:
  /// Throws FileError when the log cannot be written.
  RunConsole(const std::filesystem::path& log, bool quiet);
  ~RunConsole();

  bool shows_terminal() const { return is_terminal_ && !quiet_; }

  void log(const std::string& program, const std::string& line);
  /// A line that stays, and is logged.
  void note(const std::string& line);
  /// A line that stays.
  void show(const std::string& line);
  /// A line that the next one overwrites; without a terminal one every ten seconds.
  void update(const std::string& line);
  /// The last update stays.
  void end_update();

 private:
  std::ofstream log_;
  bool quiet_, is_terminal_;
  std::size_t open_update_ = 0;  // characters of the update on the terminal
  std::chrono::steady_clock::time_point last_update_{};
};

}  // namespace couplet::launcher
