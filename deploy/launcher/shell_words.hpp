#pragma once
// Words of a command as a shell reads them.

#include <string>

namespace couplet::launcher {

/// A word as the shell reads it back, whatever is in it.
std::string quoted(const std::string& word);

}  // namespace couplet::launcher
