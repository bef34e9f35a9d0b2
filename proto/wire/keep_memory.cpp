#include "proto/wire/keep_memory.hpp"

#include <malloc.h>

namespace couplet::wire {

void keep_freed_memory() {
  constexpr int mebibyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);  // the largest that is allowed
  mallopt(M_TRIM_THRESHOLD, 1024 * mebibyte);
  mallopt(M_TOP_PAD, 16 * mebibyte);
}

}  // namespace couplet::wire
