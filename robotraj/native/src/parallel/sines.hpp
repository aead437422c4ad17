// Sines and cosines of a pack.
#pragma once

#include "lanes.hpp"

#include <math.h>

namespace robotraj::native {
namespace {

/// pi / 2 in parts: multiples up to 2^20 of the first two are exact.
constexpr double kQuarter[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
/// Beyond this they are not.
constexpr double kFar = 1e6;
/// Added to a number, leaves its nearest integer in the last bits.
constexpr double kRounds = 0x1.8p52;

/// (-1)^k / (2 k + 1)! and (-1)^k / (2 k)!, the last ones first, but for the first two.
constexpr double kSine[] = {1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
                            1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0};
constexpr double kCosine[] = {1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
                              1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0};

template <std::size_t terms>
ROBOTRAJ_INLINE Pack polynomial(const double (&coefficients)[terms], Pack x) {
  Pack sum = Pack{} + coefficients[0];
  for (std::size_t i = 1; i < terms; ++i) sum = sum * x + coefficients[i];
  return sum;
}

/// Taylor's series of the remainder of a division by pi / 2, within 4e-16 of the C library's.
/// Source: Cody and Waite, Software Manual for the Elementary Functions, 1980, chapter 8.
ROBOTRAJ_INLINE void sines(Pack x, Pack& sine, Pack& cosine) {
  if (__builtin_expect(greatest(magnitudes(x)) > kFar, false)) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sine[lane] = ::sin(x[lane]);
      cosine[lane] = ::cos(x[lane]);
    }
    return;
  }
  const Pack rounded = x * 0x1.45f306dc9c883p-1 + kRounds, multiple = rounded - kRounds;
  const Pack r = ((x - multiple * kQuarter[0]) - multiple * kQuarter[1]) - multiple * kQuarter[2], z = r * r;
  const Pack s = r + r * z * polynomial(kSine, z), c = (1.0 - 0.5 * z) + z * z * polynomial(kCosine, z);
  const Bits quarters = (Bits)rounded, swapped = -(quarters & 1);
  const Bits of_s = (Bits)s, of_c = (Bits)c;
  sine = (Pack)(((of_s & ~swapped) | (of_c & swapped)) ^ ((quarters & 2) << 62));
  cosine = (Pack)(((of_c & ~swapped) | (of_s & swapped)) ^ (((quarters + 1) & 2) << 62));
}

}  // namespace
}  // namespace robotraj::native
