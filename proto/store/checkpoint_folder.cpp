#include "proto/store/checkpoint_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

#include "proto/checksum/crc32c.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::store {

namespace {

const std::string prefix = "step-";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what, int error) {
  throw report::FileError(path.string(), what + ": " + std::strerror(error),
                          error == ENOSPC ? "free some space" : "check the path and its permissions");
}

std::optional<std::int64_t> step_of(const std::filesystem::path& folder) {
  const std::string name = folder.filename().string();
  if (!name.starts_with(prefix)) return std::nullopt;
  std::int64_t step = 0;
  const char* const end = name.data() + name.size();
  const auto [next, error] = std::from_chars(name.data() + prefix.size(), end, step);
  if (error != std::errc() || next != end) return std::nullopt;
  return step;
}

std::filesystem::path place_of(const std::filesystem::path& checkpoints, std::int64_t step) {
  char name[32];
  std::snprintf(name, sizeof name, "%s%010lld", prefix.c_str(), static_cast<long long>(step));
  return checkpoints / name;
}

bool is_complete(const CheckpointFolder& folder) {
  return std::filesystem::exists(folder.complete_record());
}

/// Those with their own name, oldest first.
std::vector<CheckpointFolder> all_folders(const std::filesystem::path& checkpoints) {
  std::vector<CheckpointFolder> folders;
  std::error_code error;  // a folder that is not there holds none
  for (const auto& entry : std::filesystem::directory_iterator(checkpoints, error)) {
    if (const auto step = step_of(entry.path())) folders.push_back({entry.path(), *step});
  }
  std::sort(folders.begin(), folders.end(), [](const auto& a, const auto& b) { return a.step < b.step; });
  return folders;
}

/// The list goes first, so that a half removed folder is not taken for a complete one.
void remove_folder(const std::filesystem::path& folder) {
  std::error_code error;  // what cannot be removed does no harm
  std::filesystem::remove(CheckpointFolder{folder}.complete_record(), error);
  std::filesystem::remove_all(folder, error);
}

void remove_unfinished(const std::filesystem::path& checkpoints) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(checkpoints, error))
    if (entry.path().extension() == unfinished({}) && step_of(entry.path().stem())) found.push_back(entry.path());
  for (const auto& folder : found) remove_folder(folder);
}

/// Returns when a file, or the names in a folder, are on the disk.
void wait_for_disk(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) refuse(path, "cannot open", errno);
  const int error = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  if (error != 0 && error != EINVAL) refuse(path, "cannot write to the disk", error);  // EINVAL: it knows no such wait
}

struct FileCheck {
  std::uintmax_t n_bytes = 0;
  std::uint32_t checksum = 0;
  friend bool operator==(const FileCheck&, const FileCheck&) = default;
};

FileCheck check_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, "cannot read", errno);
  FileCheck check;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    const auto n = static_cast<std::size_t>(file.gcount());
    check.n_bytes += n;
    check.checksum = checksum::crc32c(block.data(), n, check.checksum);
  }
  if (file.bad()) refuse(path, "cannot read", EIO);
  return check;
}

}  // namespace

CheckpointFolder make_checkpoint_folder(const std::filesystem::path& checkpoints, std::int64_t step) {
  const CheckpointFolder folder{unfinished(place_of(checkpoints, step)), step};
  remove_folder(folder.path);
  std::error_code error;
  std::filesystem::create_directories(folder.path, error);
  if (error) refuse(folder.path, "cannot make this folder", error.value());
  return folder;
}

CheckpointFolder complete_checkpoint(const CheckpointFolder& folder, int n_kept) {
  const std::filesystem::path checkpoints = folder.path.parent_path();
  std::ostringstream list;
  list << "step " << folder.step << "\n";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const FileCheck check = check_of(file);
    list << file.filename().string() << " " << check.n_bytes << " bytes, CRC-32C " << std::hex << check.checksum
         << std::dec << "\n";
    wait_for_disk(file);
  }
  write_file(folder.complete_record(), list.str());
  wait_for_disk(folder.complete_record());
  wait_for_disk(folder.path);

  const CheckpointFolder done{place_of(checkpoints, folder.step), folder.step};
  // A run that was resumed comes by the same step again: the two change places, so that one of them is always there.
  const unsigned flags = std::filesystem::exists(done.path) ? RENAME_EXCHANGE : 0;
  if (::renameat2(AT_FDCWD, folder.path.c_str(), AT_FDCWD, done.path.c_str(), flags) != 0) {
    if (flags == 0) refuse(done.path, "cannot rename", errno);
    remove_folder(done.path);  // a file system that cannot exchange
    if (::rename(folder.path.c_str(), done.path.c_str()) != 0) refuse(done.path, "cannot rename", errno);
  }
  wait_for_disk(checkpoints);

  int n_complete = 0;
  auto folders = all_folders(checkpoints);
  std::reverse(folders.begin(), folders.end());
  for (const CheckpointFolder& other : folders) {
    // Those of later steps belong to a run that this one has resumed before them.
    const bool is_kept = other.step <= done.step && is_complete(other) && n_complete < n_kept;
    if (is_kept)
      ++n_complete;
    else
      remove_folder(other.path);
  }
  remove_unfinished(checkpoints);
  return done;
}

std::vector<CheckpointFolder> complete_checkpoints(const std::filesystem::path& checkpoints) {
  auto folders = all_folders(checkpoints);
  std::erase_if(folders, [](const auto& folder) { return !is_complete(folder); });
  return folders;
}

std::string damage_of(const CheckpointFolder& folder) {
  std::ifstream list(folder.complete_record());
  std::string line;
  std::getline(list, line);  // the step
  while (std::getline(list, line)) {
    const std::string name = line.substr(0, line.find(' '));
    FileCheck wanted;
    unsigned checksum = 0;
    unsigned long long n_bytes = 0;
    if (std::sscanf(line.c_str() + name.size(), " %llu bytes, CRC-32C %x", &n_bytes, &checksum) != 2)
      return "its list of files is cut off";
    wanted = {n_bytes, checksum};
    if (!std::filesystem::exists(folder.path / name)) return name + " is missing";
    const FileCheck found = check_of(folder.path / name);
    if (found.n_bytes != wanted.n_bytes)
      return name + " has " + std::to_string(found.n_bytes) + " bytes instead of " + std::to_string(wanted.n_bytes);
    if (!(found == wanted)) return name + " was changed: its checksum does not agree";
  }
  return {};
}

CheckpointFolder find_checkpoint(const std::filesystem::path& from,
                                 const std::function<void(const std::string&)>& warn) {
  const auto folder = from.filename().empty() ? from.parent_path() : from;  // "name/"
  const std::string other = "resume from the run folder: the newest complete one is taken";
  if (const auto step = step_of(folder)) {
    const CheckpointFolder one{folder, *step};
    if (!is_complete(one)) throw report::FileError(folder.string(), "this is not a complete checkpoint", other);
    const std::string damage = damage_of(one);
    if (!damage.empty()) throw report::FileError(folder.string(), "this checkpoint is damaged: " + damage, other);
    return one;
  }
  auto found = complete_checkpoints(RunFolder{folder}.checkpoints());
  if (found.empty()) found = complete_checkpoints(folder);
  if (found.empty())
    throw report::FileError(folder.string(), "there is no complete checkpoint here",
                            "give a run folder whose scene has output.checkpoints");
  for (; !found.empty(); found.pop_back()) {
    const std::string damage = damage_of(found.back());
    if (damage.empty()) return found.back();
    warn(found.back().path.string() + " is damaged (" + damage + "); the one before it is looked at");
  }
  throw report::FileError(folder.string(), "every checkpoint here is damaged", "start the run anew, without --resume");
}

void refuse_end_before_checkpoint(const CheckpointFolder& checkpoint, double time, double end) {
  constexpr double round_off = 1e-9;  // of summed steps
  if (time <= end * (1 + round_off)) return;
  throw report::SceneError("time.end",
                           report::text(end) + " s lies before the checkpoint " + checkpoint.path.string() +
                               ", which is of t = " + report::text(time) + " s",
                           "give a later end, or resume from an earlier checkpoint");
}

}  // namespace couplet::store
