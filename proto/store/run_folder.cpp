#include "proto/store/run_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "proto/report/failure.hpp"

namespace couplet::store {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what, int error) {
  throw report::FileError(path.string(), what + ": " + std::strerror(error),
                          error == ENOSPC ? "free some space" : "check the path and its permissions");
}

void write_all(int file, const std::filesystem::path& part, const std::filesystem::path& path,
               const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const auto count = ::write(file, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) {
      const int error = errno;
      ::close(file);
      ::unlink(part.c_str());
      refuse(path, "cannot write", error);
    }
    if (count > 0) written += static_cast<std::size_t>(count);
  }
}

}  // namespace

RunFolder make_run_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path / "results", error);
  if (error) refuse(path, "cannot make this folder", error.value());
  return RunFolder{path};
}

std::filesystem::path unfinished(const std::filesystem::path& path) {
  return path.string() + ".part";
}

void put_in_place(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::rename(unfinished(path), path, error);
  if (error) refuse(path, "cannot write", error.value());
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path part = unfinished(path);
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) refuse(path, "cannot write", errno);
  write_all(file, part, path, text);
  if (::close(file) != 0) refuse(path, "cannot write", errno);  // some file systems report a full disk only here
  put_in_place(path);
}

}  // namespace couplet::store
