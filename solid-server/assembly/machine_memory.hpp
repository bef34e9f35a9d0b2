#pragma once
// How much memory there is: what does not fit is refused before the system ends the program.

#include <unistd.h>

namespace couplet::solid {

/// Of this machine, all of it [bytes].
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

}  // namespace couplet::solid
