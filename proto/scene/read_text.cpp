#include "proto/scene/read_text.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "proto/report/failure.hpp"

namespace couplet::scene {

std::string read_text(const std::filesystem::path& path, const std::string& advice) {
  if (std::filesystem::is_directory(path)) throw report::FileError(path.string(), "is a folder", advice);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw report::FileError(path.string(), std::string("cannot be read: ") + std::strerror(errno), advice);
  return text.str();
}

}  // namespace couplet::scene
