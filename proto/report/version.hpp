#pragma once
// What this build is.

#include <string>

namespace couplet::report {

std::string version();   // of Couplet, for example 0.1.0
std::string commit();    // of the sources, at configuration time; "unknown" outside a checkout
std::string compiler();  // name, version and flags

}  // namespace couplet::report
