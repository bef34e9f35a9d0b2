#include "coupler/scheme/run_log.hpp"

#include <ctime>

namespace couplet::coupling {

void RunLog::write(const char* level, const std::string& sentence) {
  if (file_ == nullptr) return;
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char clock[32];
  std::strftime(clock, sizeof clock, "%Y-%m-%d %H:%M:%S", &local);
  std::fprintf(file_, "%s coupler %s %s\n", clock, level, sentence.c_str());
  std::fflush(file_);
}

}  // namespace couplet::coupling
