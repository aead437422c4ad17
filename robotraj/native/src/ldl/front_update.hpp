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

/// `Wide` columns of C, from the pack of row `first` down; `w` begins at the row of W that belongs to the first column.
template <int Tall, int Wide>
ROBOTRAJ_INLINE void update_columns(const double* l, const double* w, int ld, int depth, int first, double* c) {
  int i = first / kStep * kStep;
  for (; i + Tall * kStep <= ld; i += Tall * kStep) update_tile<Tall, Wide>(l + i, w, ld, depth, c + i);
  for (; i < ld; i += kStep) update_tile<1, Wide>(l + i, w, ld, depth, c + i);
}

/// One column of C.
void update_column(const double* l, const double* w, int ld, int depth, int first, double* c) {
  update_columns<4, 1>(l, w, ld, depth, first, c);
}

/// C -= L W' for the columns `first` to `rows`; L and W have `depth` columns.
void update(const double* l, const double* w, int ld, int rows, int depth, int first, double* c) {
  int j = first;
  for (; j + kWide <= rows; j += kWide) update_columns<kTall, kWide>(l, w + j, ld, depth, j, c + j * ld);
  for (; j < rows; ++j) update_column(l, w + j, ld, depth, j, c + j * ld);
}

}  // namespace
}  // namespace robotraj::native::ldl
