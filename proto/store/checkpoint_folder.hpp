#pragma once
// Where checkpoints lie: checkpoint/step-0000001000/ holds the files of every program, and the file that makes it
// complete.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::store {

/// The set of files of one checkpoint is whole when `complete` is there; that record is written last.
struct CheckpointFolder {
  std::filesystem::path path;
  std::int64_t step = 0;

  std::filesystem::path participant_file(const std::string& participant) const { return path / (participant + ".h5"); }
  std::filesystem::path complete_record() const { return path / "complete"; }
};

/// Makes checkpoint/step-NNNNNNNNNN empty (one left by a crash is replaced).
CheckpointFolder make_checkpoint_folder(const std::filesystem::path& checkpoints, std::int64_t step);

/// Writes the record that makes it complete, then removes all but the newest `n_kept` complete ones and everything
/// incomplete.
void complete_checkpoint(const CheckpointFolder& folder, int n_kept = 2);

/// Complete ones, oldest first.
std::vector<CheckpointFolder> complete_checkpoints(const std::filesystem::path& checkpoints);

/// The checkpoint to resume from: `from` is a run folder, its checkpoint folder (the newest complete one is taken) or
/// the folder of one step. Throws FileError when there is none.
CheckpointFolder find_checkpoint(const std::filesystem::path& from);

/// A checkpoint at the very end of a run may be resumed, and nothing is left to do; one that lies behind it is a
/// mistake. Throws SceneError for time.end. Times in s.
void refuse_end_before_checkpoint(const CheckpointFolder& checkpoint, double time, double end);

}  // namespace couplet::store
