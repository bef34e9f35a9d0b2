#pragma once
// e^x, as the laws of collagen need it at every point: right for every double, for eight at once.

#include <bit>
#include <cmath>

#include "solid-server/material/pack.hpp"

namespace couplet::solid {

inline double exponential(double x) {
  return std::exp(x);
}

/// With n = x / ln 2 rounded to an integer and r = x - n ln 2, e^x = 2^n e^r; |r| <= ln(2)/2, where the Taylor series
/// of degree 13 leaves 4e-18. To 1e-15 relative; beyond 709.78 infinity, below -745.2 zero, between -708 and -745 the
/// numbers with fewer digits that a double has there; not a number stays what it is.
[[gnu::always_inline]] inline Pack exponential(const Pack& x) {
  // Where the answer is infinity or zero anyway, so that n stays in the range of exponents.
  const Pack least = Pack{} - 750.0, most = Pack{} + 710.0;
  Pack clamped = x > most ? most : x;
  clamped = clamped < least ? least : clamped;
  // Adding 1.5 2^52 leaves the integer next to a number in the last bits of the sum.
  constexpr double shift = 0x1.8p52;
  const Pack shifted = clamped * 1.4426950408889634 + shift;
  const Pack rounded = shifted - shift;
  const PackMask n = std::bit_cast<PackMask>(shifted) - std::bit_cast<std::int64_t>(shift);
  // ln 2 in two parts, the first one with so few digits that its product with n is exact.
  const Pack r = (clamped - rounded * 0x1.62e42feep-1) - rounded * 0x1.a39ef35793c76p-33;
  const Pack r2 = r * r;
  // 1 + r + r^2 (sum of r^k/(k + 2)!), even and odd k apart: two short chains of operations instead of a long one.
  const Pack even =
      0.5 + r2 * (1.0 / 24 + r2 * (1.0 / 720 + r2 * (1.0 / 40320 + r2 * (1.0 / 3628800 + r2 * (1.0 / 479001600)))));
  const Pack odd =
      1.0 / 6 +
      r2 * (1.0 / 120 + r2 * (1.0 / 5040 + r2 * (1.0 / 362880 + r2 * (1.0 / 39916800 + r2 * (1.0 / 6227020800.0)))));
  const Pack mantissa = 1.0 + (r + r2 * (even + r * odd));
  // 2^n in two factors: one alone would overflow before its product with the mantissa does.
  const PackMask half = n >> 1;
  return mantissa * std::bit_cast<Pack>((half + 1023) << 52) * std::bit_cast<Pack>((n - half + 1023) << 52);
}

}  // namespace couplet::solid
