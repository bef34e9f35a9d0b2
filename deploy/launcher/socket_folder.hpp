#pragma once
// A folder for local sockets that only this user can enter; gone with the launcher.

#include <filesystem>

namespace couplet::launcher {

class SocketFolder {
 public:
  /// Throws FileError when it cannot be made. It lies in /tmp because the name of a socket must be short.
  SocketFolder();
  ~SocketFolder();
  SocketFolder(const SocketFolder&) = delete;
  SocketFolder& operator=(const SocketFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace couplet::launcher
