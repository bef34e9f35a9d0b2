#pragma once
// A checkpoint of a coupled run: both servers write their files, then the coupler writes its own, then the record that
// makes the set whole.

#include <filesystem>

#include "coupler/checkpoint/saved_state.hpp"
#include "proto/participant/participant.hpp"
#include "proto/store/checkpoint_folder.hpp"

namespace couplet::coupling {

/// The newest two whole sets are kept. Throws FileError, and what the participants throw.
void write_coupled_checkpoint(const std::filesystem::path& checkpoints, std::int64_t step,
                              participant::Participant& flow, participant::Participant& solid, const SavedState& state);

/// The coupler's part.
SavedState read_coupler_state(const store::CheckpointFolder& folder);

}  // namespace couplet::coupling
