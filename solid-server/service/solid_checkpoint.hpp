#pragma once
// The accepted state of a body on disk.

#include <string>

#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// Every number that the next step depends on. Throws FileError.
void write_checkpoint(const std::string& path, const SolidState& state);

/// Throws FileError when the file belongs to another mesh than `like` or is no checkpoint.
SolidState read_checkpoint(const std::string& path, const SolidState& like);

}  // namespace couplet::solid
