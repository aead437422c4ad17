// Sums of outer products in symmetric matrices, for one kind of processor.
#pragma once

#include "stage_vectors.hpp"

namespace robotraj::native {
namespace {

/// Columns jb to jb + 8 of M, rows r on: M += sum_k g_k s_k' or, with `minus`, M -= that; rows and columns of `ld`.
template <int packs, bool minus>
ROBOTRAJ_INLINE void tile(double* m, int ld, const double* g, const double* s, int count, int r, int jb) {
  Pack sum[packs][kBlock];
  for (int j = 0; j < kBlock; ++j)
    for (int p = 0; p < packs; ++p) sum[p][j] = load(m + (jb + j) * ld + r + p * kStep);
  for (int k = 0; k < count; ++k) {
    Pack value[packs];
    for (int p = 0; p < packs; ++p) value[p] = load(g + k * ld + r + p * kStep);
    for (int j = 0; j < kBlock; ++j) {
      const Pack factor = Pack{} + s[k * ld + jb + j];
      for (int p = 0; p < packs; ++p) minus ? sum[p][j] -= value[p] * factor : sum[p][j] += value[p] * factor;
    }
  }
  for (int j = 0; j < kBlock; ++j)
    for (int p = 0; p < packs; ++p) store(m + (jb + j) * ld + r + p * kStep, sum[p][j]);
}

/// M += sum_k g_k s_k' (or -=) in the blocks of its lower triangle; M is ld x ld by columns, g and s are rows of ld.
template <bool minus = false>
void add_products(double* m, int ld, const double* g, const double* s, int count) {
  if (count == 0) return;
  for (int jb = 0; jb < ld; jb += kBlock) {
    int r = jb;
    // Two packs of eight columns fill the registers of the widest processors.
    if (kStep == kBlock)
      for (; r + kStep < ld; r += 2 * kStep) tile<2, minus>(m, ld, g, s, count, r, jb);
    for (; r < ld; r += kStep) tile<1, minus>(m, ld, g, s, count, r, jb);
  }
}

/// Rows of `ldb` from columns of `lda`, both multiples of kBlock; a has `columns` columns.
ROBOTRAJ_INLINE void transpose(const double* a, int lda, int columns, double* b, int ldb) {
  for (int j = 0; j < columns; j += kBlock) {
    const int width = columns - j < kBlock ? columns - j : kBlock;
    for (int i = 0; i < lda; ++i)
      for (int k = 0; k < width; ++k) b[i * ldb + j + k] = a[(j + k) * lda + i];
  }
}

}  // namespace
}  // namespace robotraj::native
