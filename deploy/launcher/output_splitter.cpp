#include <utility>

#include "deploy/launcher/child_process.hpp"

namespace couplet::launcher {

std::vector<OutputLine> OutputSplitter::add(const char* bytes, std::size_t n_bytes) {
  std::vector<OutputLine> lines;
  for (std::size_t i = 0; i < n_bytes; ++i) {
    const char byte = bytes[i];
    if (byte == '\n') {
      lines.push_back({std::exchange(pending_, {}), is_update_, true});
      is_update_ = false;
    } else {
      if (after_return_ && !pending_.empty()) lines.push_back({std::exchange(pending_, {}), true, false});
      is_update_ = is_update_ || after_return_;
      if (byte != '\r') pending_ += byte;
    }
    after_return_ = byte == '\r';
  }
  return lines;
}

std::vector<OutputLine> OutputSplitter::finish() {
  if (pending_.empty()) return {};
  return {{std::exchange(pending_, {}), is_update_ || after_return_, true}};
}

}  // namespace couplet::launcher
