// Memory for packs: numbers of several points side by side, as many as the processor works on at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace robotraj::native {

/// Most points in a pack. Work is shared among threads in multiples of it; a point's results do not depend on its pack.
constexpr std::size_t kMostLanes = 8;

/// Allocates memory with the alignment of the widest vectors.
template <typename T>
struct Aligned {
  using value_type = T;
  static constexpr std::align_val_t alignment{kMostLanes * sizeof(double)};

  Aligned() = default;
  template <typename Other>
  Aligned(const Aligned<Other>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, alignment); }
  friend bool operator==(const Aligned&, const Aligned&) { return true; }
  friend bool operator!=(const Aligned&, const Aligned&) { return false; }
};

/// Packs, one after the other.
using Packs = std::vector<double, Aligned<double>>;

/// Transposes columns of `points` points (n numbers each) into n packs; the last point fills up.
inline void load(const double* columns, std::size_t n, std::size_t points, std::size_t lanes, double* packs) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const double* column = columns + std::min(lane, points - 1) * n;
    for (std::size_t i = 0; i < n; ++i) packs[i * lanes + lane] = column[i];
  }
}

/// Transposes n packs into the columns of `points` points.
inline void store(const double* packs, std::size_t n, std::size_t points, std::size_t lanes, double* columns) {
  for (std::size_t lane = 0; lane < points; ++lane)
    for (std::size_t i = 0; i < n; ++i) columns[lane * n + i] = packs[i * lanes + lane];
}

}  // namespace robotraj::native
