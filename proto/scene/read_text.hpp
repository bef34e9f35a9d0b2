#pragma once
// The text of a file that a user has written.

#include <filesystem>
#include <string>

namespace couplet::scene {

/// Throws FileError with the advice when it cannot be read.
std::string read_text(const std::filesystem::path& path, const std::string& advice);

}  // namespace couplet::scene
