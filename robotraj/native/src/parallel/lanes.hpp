// The packs of one kind of processor; ROBOTRAJ_LANES is the number of points that they hold.
//
// Everything of the kernels has internal linkage: it means something else in each of their files.
#pragma once

#include <cstddef>
#include <cstdint>

#define ROBOTRAJ_INLINE static inline __attribute__((always_inline))

namespace robotraj::native {
namespace {

constexpr std::size_t kLanes = ROBOTRAJ_LANES;
constexpr int kStep = static_cast<int>(kLanes);

/// One number of kLanes points.
typedef double Pack __attribute__((vector_size(kLanes * sizeof(double)), may_alias));
typedef std::uint64_t Bits __attribute__((vector_size(kLanes * sizeof(double)), may_alias));

/// kLanes numbers that stand anywhere.
typedef double Loose __attribute__((vector_size(kLanes * sizeof(double)), aligned(8), may_alias));

ROBOTRAJ_INLINE const Pack* packs(const double* numbers) { return reinterpret_cast<const Pack*>(numbers); }
ROBOTRAJ_INLINE Pack* packs(double* numbers) { return reinterpret_cast<Pack*>(numbers); }

/// The numbers at these places of two packs, counted through both. GCC 11 and clang have no common name for it.
template <std::size_t... place>
ROBOTRAJ_INLINE Pack picked(Pack first, Pack second) {
#ifdef __clang__
  return __builtin_shufflevector(first, second, place...);
#else
  return __builtin_shuffle(first, second, Bits{place...});
#endif
}

ROBOTRAJ_INLINE double magnitude(double x) { return x < 0.0 ? -x : x; }
ROBOTRAJ_INLINE Pack magnitudes(Pack x) { return reinterpret_cast<Pack>(reinterpret_cast<Bits>(x) & (~0ull >> 1)); }
ROBOTRAJ_INLINE double greatest(Pack x) {
  double result = x[0];
  for (int i = 1; i < kStep; ++i) result = x[i] > result ? x[i] : result;
  return result;
}

}  // namespace
}  // namespace robotraj::native
