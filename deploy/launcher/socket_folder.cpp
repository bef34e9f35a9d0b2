#include "deploy/launcher/socket_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::launcher {

SocketFolder::SocketFolder() {
  std::string name = "/tmp/couplet-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) {
    throw report::FileError(name, std::strerror(errno), "make room in /tmp, or name addresses with coupling.listen");
  }
  path_ = name;
}

SocketFolder::~SocketFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace couplet::launcher
