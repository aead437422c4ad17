// Rows of a sparse combination that repeat from interval to interval, for a pack of intervals.
#pragma once

#include "kernels/packed.hpp"
#include "parallel/lanes.hpp"

#include <utility>

namespace robotraj::native {
namespace {

template <std::size_t half, std::size_t... lane>
ROBOTRAJ_INLINE void exchange(Pack& low, Pack& high, std::index_sequence<lane...>) {
  const Pack first = low, second = high;
  low = picked<(lane & half ? kLanes + lane - half : lane)...>(first, second);
  high = picked<(lane & half ? kLanes + lane : lane + half)...>(first, second);
}

/// Rows of a square become its columns.
template <std::size_t half = 1>
ROBOTRAJ_INLINE void transpose(Pack (&square)[kLanes]) {
  if constexpr (half < kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i)
      if (!(i & half)) exchange<half>(square[i], square[i + half], std::make_index_sequence<kLanes>());
    transpose<2 * half>(square);
  }
}

/// Whether a pack of places follow each other.
ROBOTRAJ_INLINE bool in_a_row(const std::int32_t* places) { return places[kLanes - 1] - places[0] == kStep - 1; }

/// Numbers at `places`, which ascend, of `count` repeats `step` apart, side by side: number i to pack order[i], or to
/// pack i. The last repeat fills the packs.
template <bool ordered>
void take(const double* numbers, const std::int32_t* places, const std::int32_t* order, std::size_t many,
          std::ptrdiff_t step, std::size_t count, Pack* out) {
  const auto to = [=](std::size_t i) -> Pack& { return out[ordered ? order[i] : i]; };
  for (std::size_t i = 0; i < many;) {
    if (count == kLanes && i + kLanes <= many && in_a_row(places + i)) {
      Pack square[kLanes];
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        square[lane] = *reinterpret_cast<const Loose*>(numbers + places[i] + static_cast<std::ptrdiff_t>(lane) * step);
      transpose(square);
      for (std::size_t k = 0; k < kLanes; ++k) to(i + k) = square[k];
      i += kLanes;
    } else {
      Pack pack;
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        pack[lane] = numbers[places[i] + static_cast<std::ptrdiff_t>(lane < count ? lane : count - 1) * step];
      to(i++) = pack;
    }
  }
}

/// The inverse: pack order[i] to place i of each repeat.
void give(const Pack* packs, const std::int32_t* order, const std::int32_t* places, std::size_t many,
          std::ptrdiff_t step, std::size_t count, double* numbers) {
  for (std::size_t i = 0; i < many;) {
    if (count == kLanes && i + kLanes <= many && in_a_row(places + i)) {
      Pack square[kLanes];
      for (std::size_t k = 0; k < kLanes; ++k) square[k] = packs[order[i + k]];
      transpose(square);
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        *reinterpret_cast<Loose*>(numbers + places[i] + static_cast<std::ptrdiff_t>(lane) * step) = square[lane];
      i += kLanes;
    } else {
      const Pack pack = packs[order[i]];
      for (std::size_t lane = 0; lane < count; ++lane)
        numbers[places[i] + static_cast<std::ptrdiff_t>(lane) * step] = pack[lane];
      ++i;
    }
  }
}

template <std::size_t fixed>
void add_rows(const RowGroup& group, const std::int32_t* columns, const double* values, const Pack* x, Pack* sums) {
  const std::size_t count = fixed ? fixed : group.count;
  for (std::size_t i = 0; i < group.rows; ++i, columns += count, values += count) {
    Pack sum = sums[i];
    for (std::size_t e = 0; e < count; ++e) sum += values[e] * x[columns[e]];
    sums[i] = sum;
  }
}

void combine_rows(const RepeatedRows& block, const RepeatSteps& steps, const double* x, const double* base, double* y,
                  std::size_t count, double* memory) {
  Pack *const read = packs(memory), *const results = read + block.read_count;
  take<false>(x, block.reads, nullptr, block.read_count, steps.x, count, read);
  if (base) take<true>(base, block.from, block.order, block.row_count, steps.base, count, results);
  else
    for (std::size_t i = 0; i < block.row_count; ++i)
      results[i] = Pack{} + (block.kept_base ? block.kept_base[i] : 0.0);
  Pack* sums = results;
  const std::int32_t* columns = block.columns;
  const double* values = block.values;
  for (std::size_t g = 0; g < block.group_count; ++g) {
    const RowGroup& group = block.groups[g];
    switch (group.count) {
      case 0: break;
      case 1: add_rows<1>(group, columns, values, read, sums); break;
      case 2: add_rows<2>(group, columns, values, read, sums); break;
      case 3: add_rows<3>(group, columns, values, read, sums); break;
      case 4: add_rows<4>(group, columns, values, read, sums); break;
      case 5: add_rows<5>(group, columns, values, read, sums); break;
      case 6: add_rows<6>(group, columns, values, read, sums); break;
      default: add_rows<0>(group, columns, values, read, sums);
    }
    sums += group.rows;
    columns += group.rows * group.count;
    values += group.rows * group.count;
  }
  give(results, block.order, block.places, block.row_count, steps.y, count, y);
}

}  // namespace
}  // namespace robotraj::native
