#pragma once
// The files that a run leaves in its folder: the names that people and scripts rely on.

#include <filesystem>
#include <string>

namespace couplet::store {

struct RunFolder {
  std::filesystem::path path;

  std::filesystem::path summary() const { return path / "summary.json"; }
  std::filesystem::path history() const { return path / "history.csv"; }
  std::filesystem::path iterations() const { return path / "iterations.csv"; }
  std::filesystem::path results() const { return path / "results"; }
  std::filesystem::path report() const { return path / "report.html"; }
  std::filesystem::path resolved_scene() const { return path / "resolved_scene.txtpb"; }
  std::filesystem::path checkpoints() const { return path / "checkpoint"; }
  std::filesystem::path log() const { return path / "log.txt"; }
};

/// Makes the folder and results/ in it; throws FileError naming the folder and the reason.
RunFolder make_run_folder(const std::filesystem::path& path);

/// The name of a file while it is written, in the folder of `path`. What stays behind under it after a kill is
/// worthless.
std::filesystem::path unfinished(const std::filesystem::path& path);
/// Gives what was written under the unfinished name its own, in place of any file of that name, in one step. Throws
/// FileError.
void put_in_place(const std::filesystem::path& path);

/// Writes the whole text or nothing. Throws FileError.
void write_file(const std::filesystem::path& path, const std::string& text);

}  // namespace couplet::store
