#include "proto/store/checkpoint_folder.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <system_error>

#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::store {

namespace {

const std::string prefix = "step-";

std::optional<std::int64_t> step_of(const std::filesystem::path& folder) {
  const std::string name = folder.filename().string();
  if (!name.starts_with(prefix)) return std::nullopt;
  std::int64_t step = 0;
  const char* const end = name.data() + name.size();
  const auto [next, error] = std::from_chars(name.data() + prefix.size(), end, step);
  if (error != std::errc() || next != end) return std::nullopt;
  return step;
}

bool is_complete(const CheckpointFolder& folder) {
  return std::filesystem::exists(folder.complete_record());
}

std::vector<CheckpointFolder> all_folders(const std::filesystem::path& checkpoints) {
  std::vector<CheckpointFolder> folders;
  std::error_code error;  // a folder that is not there holds none
  for (const auto& entry : std::filesystem::directory_iterator(checkpoints, error)) {
    if (const auto step = step_of(entry.path())) folders.push_back({entry.path(), *step});
  }
  std::sort(folders.begin(), folders.end(), [](const auto& a, const auto& b) { return a.step < b.step; });
  return folders;
}

}  // namespace

CheckpointFolder make_checkpoint_folder(const std::filesystem::path& checkpoints, std::int64_t step) {
  char name[32];
  std::snprintf(name, sizeof name, "%s%010lld", prefix.c_str(), static_cast<long long>(step));
  const CheckpointFolder folder{checkpoints / name, step};
  std::error_code error;
  // The record goes first, so that a half removed folder is not taken for a complete one.
  std::filesystem::remove(folder.complete_record(), error);
  std::filesystem::remove_all(folder.path, error);
  std::filesystem::create_directories(folder.path, error);
  if (error)
    throw report::FileError(folder.path.string(), "cannot make this folder: " + error.message(),
                            "check the path and its permissions");
  return folder;
}

void complete_checkpoint(const CheckpointFolder& folder, int n_kept) {
  write_file(folder.complete_record(), "step " + std::to_string(folder.step) + "\n");
  int n_complete = 0;
  auto folders = all_folders(folder.path.parent_path());
  std::reverse(folders.begin(), folders.end());
  for (const CheckpointFolder& other : folders) {
    // Those of later steps belong to a run that this one has resumed before them.
    const bool is_kept = other.step <= folder.step && is_complete(other) && n_complete < n_kept;
    if (is_kept) {
      ++n_complete;
      continue;
    }
    std::error_code error;  // what cannot be removed does no harm
    std::filesystem::remove(other.complete_record(), error);
    std::filesystem::remove_all(other.path, error);
  }
}

std::vector<CheckpointFolder> complete_checkpoints(const std::filesystem::path& checkpoints) {
  auto folders = all_folders(checkpoints);
  std::erase_if(folders, [](const auto& folder) { return !is_complete(folder); });
  return folders;
}

CheckpointFolder find_checkpoint(const std::filesystem::path& from) {
  const auto folder = from.filename().empty() ? from.parent_path() : from;  // "name/"
  if (const auto step = step_of(folder)) {
    const CheckpointFolder one{folder, *step};
    if (is_complete(one)) return one;
    throw report::FileError(folder.string(), "this is not a complete checkpoint",
                            "resume from the run folder: the newest complete one is taken");
  }
  auto found = complete_checkpoints(RunFolder{folder}.checkpoints());
  if (found.empty()) found = complete_checkpoints(folder);
  if (found.empty())
    throw report::FileError(folder.string(), "there is no complete checkpoint here",
                            "give a run folder whose scene has output.checkpoints");
  return found.back();
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
