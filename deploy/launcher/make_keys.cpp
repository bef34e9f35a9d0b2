#include "deploy/launcher/make_keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

using std::filesystem::path;

/// The file is never readable by others, not even for a moment.
void write_key(const path& file, const char* key, mode_t mode) {
  const int handle = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  const std::string line = std::string(key) + "\n";
  const bool written = handle >= 0 && write(handle, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (handle >= 0) close(handle);
  if (!written) throw report::FileError(file.string(), std::strerror(errno), "choose a folder that you may write to");
}

}  // namespace

void make_keys(const path& folder) {
  constexpr std::array programs{"coupler", "flow-server", "solid-server"};
  for (const std::string program : programs) {
    for (const std::string ending : {".key", ".pub"}) {
      if (std::filesystem::exists(folder / (program + ending))) {
        throw report::SceneError((folder / (program + ending)).string(), "there is a key already",
                                 "choose another folder, or remove the old keys on all hosts first");
      }
    }
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw report::FileError(folder.string(), error.message(), "choose a folder that you may write to");
  for (const std::string program : programs) {
    char public_key[41], secret_key[41];  // Z85 text and its end, as libzmq wants them
    if (zmq_curve_keypair(public_key, secret_key) != 0) {
      throw report::FileError("libzmq", "this build of ZeroMQ has no CURVE", "install Debian's libzmq5");
    }
    write_key(folder / (program + ".key"), secret_key, 0600);
    write_key(folder / (program + ".pub"), public_key, 0644);
  }
  std::printf("wrote the keys of coupler, flow-server and solid-server into %s\n", folder.c_str());
  std::printf("give each host the .key of its own program and the .pub of the others\n");
}

}  // namespace couplet::launcher
