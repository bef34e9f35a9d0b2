#pragma once
// Eight numbers that are computed on at once: one for each of eight elements. The compiler maps a pack to the widest
// registers of the processor it compiles for (one of AVX-512, two of AVX2, four of SSE2).

#include <cstdint>
#include <cstring>

namespace couplet::solid {

constexpr int n_lanes = 8;

using Pack = double __attribute__((vector_size(8 * n_lanes)));
using PackMask = std::int64_t __attribute__((vector_size(8 * n_lanes)));

/// A pack in memory.
struct alignas(64) StoredPack {
  double lane[n_lanes];
};

[[gnu::always_inline]] inline Pack load(const StoredPack& stored) {
  Pack pack;
  std::memcpy(&pack, &stored, sizeof pack);
  return pack;
}

[[gnu::always_inline]] inline void store(const Pack& pack, StoredPack& stored) {
  std::memcpy(&stored, &pack, sizeof pack);
}

[[gnu::always_inline]] inline bool all_true(PackMask mask) {
  mask &= __builtin_shufflevector(mask, mask, 4, 5, 6, 7, 0, 1, 2, 3);
  mask &= __builtin_shufflevector(mask, mask, 2, 3, 0, 1, 6, 7, 4, 5);
  return mask[0] != 0 && mask[1] != 0;
}

}  // namespace couplet::solid
