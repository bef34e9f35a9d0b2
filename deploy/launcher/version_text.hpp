#pragma once

#include <string>

namespace couplet::launcher {

/// Version, commit, compiler and the versions of the libraries, a line each.
std::string version_text();

}  // namespace couplet::launcher
