#pragma once
// Where checkpoints lie: checkpoint/step-0000001000/ holds the files of every program, and the list of them that makes
// it complete.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace couplet::store {

/// While it is written its name ends in `.part`; it gets its own, all at once, when everything in it has reached the
/// disk. The list `complete`, written last, names every file with its size and checksum.
struct CheckpointFolder {
  std::filesystem::path path;
  std::int64_t step = 0;

  std::filesystem::path participant_file(const std::string& participant) const { return path / (participant + ".h5"); }
  std::filesystem::path complete_record() const { return path / "complete"; }
};

/// Makes checkpoint/step-NNNNNNNNNN.part empty (one left by a crash is replaced).
CheckpointFolder make_checkpoint_folder(const std::filesystem::path& checkpoints, std::int64_t step);

/// Lists its files, waits until all of it is on the disk and gives it its name; then removes all but the newest
/// `n_kept` complete ones and everything incomplete. Comes back with where it lies now. Throws FileError; what was
/// complete before then stays so.
CheckpointFolder complete_checkpoint(const CheckpointFolder& folder, int n_kept = 2);

/// Complete ones, oldest first.
std::vector<CheckpointFolder> complete_checkpoints(const std::filesystem::path& checkpoints);

/// What is wrong with the files of a complete one, in words: one is missing, has another size or another checksum.
/// Empty: nothing.
std::string damage_of(const CheckpointFolder& folder);

/// The checkpoint to resume from: `from` is a run folder, its checkpoint folder (the newest complete one that is not
/// damaged is taken; of damaged ones before it `warn` is told) or the folder of one step. Throws FileError when there
/// is none.
CheckpointFolder find_checkpoint(const std::filesystem::path& from,
                                 const std::function<void(const std::string&)>& warn);

/// A checkpoint at the very end of a run may be resumed, and nothing is left to do; one that lies behind it is a
/// mistake. Throws SceneError for time.end. Times in s.
void refuse_end_before_checkpoint(const CheckpointFolder& checkpoint, double time, double end);

}  // namespace couplet::store
