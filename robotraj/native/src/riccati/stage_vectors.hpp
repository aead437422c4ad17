// Products of a stage's matrices with vectors, and sums of outer products, for one kind of processor.
//
// Vectors of a stage are in memory of their own here, padded with zeros to a multiple of kBlock.
#pragma once

#include "parallel/lanes.hpp"
#include "riccati.hpp"

namespace robotraj::native {
namespace {

ROBOTRAJ_INLINE Pack load(const double* x) { return *reinterpret_cast<const Loose*>(x); }
ROBOTRAJ_INLINE void store(double* x, Pack value) { *reinterpret_cast<Loose*>(x) = value; }

/// The sum of a pack's numbers, halves added to halves.
ROBOTRAJ_INLINE double across(Pack v) {
#if ROBOTRAJ_LANES == 8
  v += picked<4, 5, 6, 7, 0, 1, 2, 3>(v, v);
  v += picked<2, 3, 0, 1, 4, 5, 6, 7>(v, v);
#elif ROBOTRAJ_LANES == 4
  v += picked<2, 3, 0, 1>(v, v);
#endif
  return v[0] + v[1];
}

ROBOTRAJ_INLINE void clear(double* x, int n) {
  for (int i = 0; i < n; ++i) x[i] = 0.0;
}

ROBOTRAJ_INLINE void copy(const double* from, int n, double* to) {
  for (int i = 0; i < n; ++i) to[i] = from[i];
}

/// Copies n numbers and fills up with zeros.
ROBOTRAJ_INLINE void copy_padded(const double* from, int n, double* to) {
  copy(from, n, to);
  for (int i = n; i < padded(n); ++i) to[i] = 0.0;
}

/// out = x / y, n numbers.
ROBOTRAJ_INLINE void divide_by(const double* x, const double* y, int n, double* out) {
  int i = 0;
  for (; i + kStep <= n; i += kStep) store(out + i, load(x + i) / load(y + i));
  for (; i < n; ++i) out[i] = x[i] / y[i];
}

/// y += a x, from `first`, a multiple of kBlock, to `ld`.
ROBOTRAJ_INLINE void add(int first, int ld, double a, const double* x, double* y) {
  for (int i = first; i < ld; i += kStep) store(y + i, load(y + i) + a * load(x + i));
}

ROBOTRAJ_INLINE double dot(int first, int ld, const double* x, const double* y) {
  Pack sum{};
  for (int i = first; i < ld; i += kStep) sum += load(x + i) * load(y + i);
  return across(sum);
}

/// out = rows times z, z padded to ld.
ROBOTRAJ_INLINE void times(const RowsView& rows, int ld, const double* z, double* out) {
  const double* value = rows.values;
  for (int r = 0; r < rows.wide_count; ++r, value += ld) out[rows.wide[r]] = dot(0, ld, value, z);
  for (int r = 0; r < rows.thin_count; ++r) {
    double sum = 0.0;
    for (int e = rows.starts[r]; e < rows.starts[r + 1]; ++e) sum += value[e] * z[rows.columns[e]];
    out[rows.thin[r]] = sum;
  }
}

/// z += rows' y.
ROBOTRAJ_INLINE void add_transposed(const RowsView& rows, int ld, const double* y, double* z) {
  const double* value = rows.values;
  for (int r = 0; r < rows.wide_count; ++r, value += ld) add(0, ld, y[rows.wide[r]], value, z);
  for (int r = 0; r < rows.thin_count; ++r) {
    const double factor = y[rows.thin[r]];
    for (int e = rows.starts[r]; e < rows.starts[r + 1]; ++e) z[rows.columns[e]] += factor * value[e];
  }
}

/// y += A x, A symmetric in a trapezoid of n columns; x is padded with zeros, and A too.
ROBOTRAJ_INLINE void add_symmetric(const double* a, int n, const double* x, double* y) {
  const int ld = padded(n);
  for (int j = 0; j < n; ++j) {
    const double* column = a + column_of(j, ld);
    const Pack factor = Pack{} + x[j];
    Pack sum{};
    for (int i = j / kBlock * kBlock; i < ld; i += kStep) {
      const Pack value = load(column + i);
      sum += value * load(x + i);
      store(y + i, load(y + i) + factor * value);
    }
    // The diagonal is in both the column and the row.
    y[j] += across(sum) - column[j] * x[j];
  }
}

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

// --- an entry of `RiccatiKernels`

/// out += the three Jacobians of a stage, transposed, times their multipliers; `memory` has padded(n) numbers.
void transposed_times(const StageView& stage, const double* dynamics, const double* equalities,
                      const double* inequalities, double* out, double* memory) {
  const int n = stage.nu + stage.nx, ld = padded(n);
  clear(memory, ld);
  add_transposed(stage.dynamics, ld, dynamics, memory);
  add_transposed(stage.equalities, ld, equalities, memory);
  add_transposed(stage.inequalities, ld, inequalities, memory);
  for (int i = 0; i < n; ++i) out[i] += memory[i];
}

}  // namespace
}  // namespace robotraj::native
