#include "deploy/launcher/installation.hpp"

#include "proto/report/failure.hpp"

namespace couplet::launcher {

std::string Installation::program(const std::string& name) const {
  const std::filesystem::path path = programs / name;
  if (!std::filesystem::exists(path)) {
    throw report::FileError(path.string(), "this program is missing", "build it: cmake --build --preset release");
  }
  return path.string();
}

std::string Installation::script(const std::string& name) const {
  const std::filesystem::path path = sources / name;
  if (!std::filesystem::exists(path)) {
    throw report::FileError(path.string(), "this script is missing", "run from a complete checkout");
  }
  return path.string();
}

Installation find_installation() {
  return {std::filesystem::read_symlink("/proc/self/exe").parent_path(), COUPLET_SOURCE_FOLDER, "/usr/bin/python3"};
}

}  // namespace couplet::launcher
