#include "deploy/launcher/mpi_output.hpp"

#include <regex>

namespace couplet::launcher {

std::string take_mpi_tag(std::string& line) {
  static const std::regex tag(R"(^\[\d+,(\d+)\]<std(?:out|err|diag)>:\s?)");
  std::smatch found;
  if (!std::regex_search(line, found, tag)) return "mpirun";
  const std::string speaker = "rank " + found[1].str();
  line = found.suffix();
  return speaker;
}

std::string take_mpi_tags(std::string& update) {
  static const std::regex tag(R"(\[\d+,\d+\]<std(?:out|err|diag)>:)");
  update = std::regex_replace(update, tag, "");
  return "rank 0";
}

bool is_last_word(const std::string& line) {
  static const std::regex beginning("^(coupler|flow-server|solid-server|couplet): ");
  return std::regex_search(line, beginning);
}

}  // namespace couplet::launcher
