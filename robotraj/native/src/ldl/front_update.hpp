// Update of the rest of a front by its pivots: C -= L W' on the lower triangle, for one kind of processor.
#pragma once

#include "front.hpp"
#include "parallel/lanes.hpp"

namespace robotraj::native::ldl {
namespace {

/// Packs of rows and columns that stay in registers.
constexpr int kTall = kLanes == 2 ? 2 : 3;
constexpr int kWide = kLanes == 8 ? 8 : 4;

/// `Tall` packs of rows and `Wide` columns of C, `depth` products each.
template <int Tall, int Wide>
ROBOTRAJ_INLINE void update_tile(const double* l, const double* w, int ld, int depth, double* c) {
  Pack sum[Wide][Tall];
#pragma GCC unroll 8
  for (int j = 0; j < Wide; ++j)
#pragma GCC unroll 4
    for (int i = 0; i < Tall; ++i) sum[j][i] = packs(c + j * ld)[i];
  for (int p = 0; p < depth; ++p, l += ld, w += ld) {
    Pack left[Tall];
#pragma GCC unroll 4
    for (int i = 0; i < Tall; ++i) left[i] = packs(l)[i];
#pragma GCC unroll 8
    for (int j = 0; j < Wide; ++j) {
      const Pack right = Pack{} + w[j];
#pragma GCC unroll 4
      for (int i = 0; i < Tall; ++i) sum[j][i] -= left[i] * right;
    }
  }
#pragma GCC unroll 8
  for (int j = 0; j < Wide; ++j)
#pragma GCC unroll 4
    for (int i = 0; i < Tall; ++i) packs(c + j * ld)[i] = sum[j][i];
}

/// Columns j, ... j + Wide of C, from their diagonal down.
template <int Wide>
ROBOTRAJ_INLINE void update_columns(const double* l, const double* w, int ld, int depth, int j, double* c) {
  int i = j / kStep * kStep;
  for (; i + kTall * kStep <= ld; i += kTall * kStep) update_tile<kTall, Wide>(l + i, w + j, ld, depth, c + j * ld + i);
  for (; i < ld; i += kStep) update_tile<1, Wide>(l + i, w + j, ld, depth, c + j * ld + i);
}

/// C -= L W' for the columns `first` to `rows`; L and W have `depth` columns.
void update(const double* l, const double* w, int ld, int rows, int depth, int first, double* c) {
  int j = first;
  for (; j + kWide <= rows; j += kWide) update_columns<kWide>(l, w, ld, depth, j, c);
  for (; j < rows; ++j) update_columns<1>(l, w, ld, depth, j, c);
}

}  // namespace
}  // namespace robotraj::native::ldl
