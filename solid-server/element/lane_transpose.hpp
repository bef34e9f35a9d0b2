#pragma once
// Eight nodes of three components each: from memory, where a node stands together, to packs, where a component stands
// together, and back.

#include "solid-server/material/pack.hpp"

namespace couplet::solid {

/// A node in memory: x, y, z and a fourth number that is not used.
using NodeQuad = double __attribute__((vector_size(32)));

[[gnu::always_inline]] inline NodeQuad load_quad(const double* start) {
  NodeQuad quad;
  std::memcpy(&quad, start, sizeof quad);
  return quad;
}

/// The nodes that begin at values[start[lane]].
[[gnu::always_inline]] inline void load_nodes(const double* values, const std::int32_t* start, Pack& x, Pack& y,
                                              Pack& z) {
  const auto pair = [&](int lane) {
    return __builtin_shufflevector(load_quad(values + start[lane]), load_quad(values + start[lane + 4]), 0, 1, 2, 3, 4,
                                   5, 6, 7);
  };
  const Pack r04 = pair(0), r15 = pair(1), r26 = pair(2), r37 = pair(3);
  const Pack xz01 = __builtin_shufflevector(r04, r15, 0, 8, 2, 10, 4, 12, 6, 14);
  const Pack xz23 = __builtin_shufflevector(r26, r37, 0, 8, 2, 10, 4, 12, 6, 14);
  const Pack y01 = __builtin_shufflevector(r04, r15, 1, 9, 3, 11, 5, 13, 7, 15);
  const Pack y23 = __builtin_shufflevector(r26, r37, 1, 9, 3, 11, 5, 13, 7, 15);
  x = __builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13);
  y = __builtin_shufflevector(y01, y23, 0, 1, 8, 9, 4, 5, 12, 13);
  z = __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Where a lane stands in the 4 packs that store_nodes writes: at 4 * lane_place(lane).
constexpr int lane_place(int lane) {
  return lane < 4 ? 2 * lane : 2 * (lane - 4) + 1;
}

/// Four packs: eight nodes of x, y, z, 0.
[[gnu::always_inline]] inline void store_nodes(const Pack& x, const Pack& y, const Pack& z, StoredPack* out) {
  const Pack zero{};
  const Pack xz01 = __builtin_shufflevector(x, z, 0, 1, 8, 9, 4, 5, 12, 13);
  const Pack xz23 = __builtin_shufflevector(x, z, 2, 3, 10, 11, 6, 7, 14, 15);
  const Pack y01 = __builtin_shufflevector(y, zero, 0, 1, 8, 9, 4, 5, 12, 13);
  const Pack y23 = __builtin_shufflevector(y, zero, 2, 3, 10, 11, 6, 7, 14, 15);
  store(__builtin_shufflevector(xz01, y01, 0, 8, 2, 10, 4, 12, 6, 14), out[0]);
  store(__builtin_shufflevector(xz01, y01, 1, 9, 3, 11, 5, 13, 7, 15), out[1]);
  store(__builtin_shufflevector(xz23, y23, 0, 8, 2, 10, 4, 12, 6, 14), out[2]);
  store(__builtin_shufflevector(xz23, y23, 1, 9, 3, 11, 5, 13, 7, 15), out[3]);
}

}  // namespace couplet::solid
