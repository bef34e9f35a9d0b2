#pragma once
// log.txt: what the coupler did beside the ordinary, one line an event.

#include <cstdio>
#include <filesystem>
#include <string>

namespace couplet::coupling {

/// Appends `time coupler level sentence`; other programs may append to the same file. A log that cannot be written is
/// no reason to end a run: it stays silent then.
class RunLog {
 public:
  explicit RunLog(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "a")) {}
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;
  ~RunLog() {
    if (file_ != nullptr) std::fclose(file_);
  }

  void note(const std::string& sentence) { write("note", sentence); }
  void warn(const std::string& sentence) { write("warning", sentence); }
  void error(const std::string& sentence) { write("error", sentence); }

 private:
  void write(const char* level, const std::string& sentence);
  std::FILE* file_;
};

}  // namespace couplet::coupling
