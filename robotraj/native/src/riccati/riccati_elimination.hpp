// Constraints of a stage, solved for controls: Gaussian elimination with full pivoting, for one kind of processor.
#pragma once

#include "riccati.hpp"
#include "stage_vectors.hpp"

namespace robotraj::native {
namespace {

ROBOTRAJ_INLINE Elimination parts_of(const StageFactor& factor) {
  const int nu = factor.nu, most = factor.most;
  double* at = factor.elimination;
  const auto take = [&at](std::size_t count) {
    double* here = at;
    if (at) at += count;  // a stage without constraints has no memory for them
    return here;
  };
  Elimination parts;
  parts.lower = take(numbers(most, nu));
  parts.upper = take(numbers(nu, nu));
  parts.k_matrix = take(numbers(nu, padded(nu + factor.nx)));
  parts.s_matrix = take(numbers(nu, padded(nu + factor.nx)));
  parts.m_aa = take(numbers(nu, nu));
  parts.m_a = take(numbers(nu, 1));
  parts.k = take(numbers(nu, 1));
  parts.h_matrix = take(numbers(most, padded(factor.nx)));
  parts.h = take(numbers(most, 1));
  parts.rows = take(numbers(nu, 1));
  parts.columns = take(numbers(nu, 1));
  return parts;
}

ROBOTRAJ_INLINE void swap(double& a, double& b) {
  const double kept = a;
  a = b;
  b = kept;
}

ROBOTRAJ_INLINE void swap_rows(double* a, double* b, int n) {
  for (int i = 0; i < n; ++i) swap(a[i], b[i]);
}

/// C: the stage's equalities, then H [B A] of the constraints that the next stage has left.
void gather_constraints(const StageView& stage, const StageFactor* next, double* c) {
  const int ld = padded(stage.nu + stage.nx);
  const RowsView& own = stage.equalities;
  clear(c, stage.equality_count * ld);
  for (int r = 0; r < own.wide_count; ++r) copy(own.values + r * ld, ld, c + own.wide[r] * ld);
  const double* thin = own.values + own.wide_count * ld;
  for (int r = 0; r < own.thin_count; ++r)
    for (int e = own.starts[r]; e < own.starts[r + 1]; ++e) c[own.thin[r] * ld + own.columns[e]] = thin[e];
  if (!next) return;
  const double* h = parts_of(*next).h_matrix;
  c += stage.equality_count * ld;
  for (int r = 0; r < next->gamma - next->rank; ++r, h += padded(stage.next), c += ld) {
    clear(c, ld);
    add_transposed(stage.dynamics, ld, h, c);
  }
}

/// Makes M full and symmetric.
void mirror(double* m, int ld, int n) {
  for (int j = 0; j < n; ++j)
    for (int i = j + 1; i < n; ++i) m[i * ld + j] = m[j * ld + i];
}

/// Solves C for as many controls as its rank in u: fills `factor`'s elimination, and memory.reduced where rank > 0.
void eliminate(int gamma, double tolerance, RiccatiMemory& memory, StageFactor& factor) {
  const int nu = factor.nu, nx = factor.nx, n = nu + nx, ld = padded(n);
  const Elimination parts = parts_of(factor);
  double *c = memory.constraints, *m = memory.matrix;
  mirror(m, ld, n);
  int rank = 0;
  for (; rank < gamma && rank < nu; ++rank) {
    int row = rank, column = rank;
    for (int i = rank; i < gamma; ++i)
      for (int j = rank; j < nu; ++j)
        if (magnitude(c[i * ld + j]) > magnitude(c[row * ld + column])) row = i, column = j;
    if (!(magnitude(c[row * ld + column]) >= tolerance)) break;
    parts.rows[rank] = row;
    parts.columns[rank] = column;
    swap_rows(c + rank * ld, c + row * ld, ld);
    for (int t = 0; t < rank; ++t) swap(parts.lower[t * factor.most + rank], parts.lower[t * factor.most + row]);
    for (int i = 0; i < gamma; ++i) swap(c[i * ld + rank], c[i * ld + column]);
    swap_rows(m + rank * ld, m + column * ld, n);
    for (int j = 0; j < n; ++j) swap(m[j * ld + rank], m[j * ld + column]);
    const double* pivot = c + rank * ld;
    for (int i = rank + 1; i < gamma; ++i) {
      const double multiplier = c[i * ld + rank] / pivot[rank];
      parts.lower[rank * factor.most + i] = multiplier;
      add(0, ld, -multiplier, pivot, c + i * ld);
    }
  }
  factor.rank = rank;
  for (int t = 0; t < rank; ++t) copy(c + t * ld, rank, parts.upper + t * nu);
  for (int i = rank; i < gamma; ++i) copy_padded(c + i * ld + nu, nx, parts.h_matrix + (i - rank) * padded(nx));
  if (rank == 0) return;

  // K = U^-1 times the other columns.
  const int ny = n - rank, ldy = padded(ny);
  double* a = memory.first;
  for (int t = rank - 1; t >= 0; --t) {
    double* row = parts.k_matrix + t * ldy;
    copy_padded(c + t * ld + rank, ny, row);
    for (int s = t + 1; s < rank; ++s) add(0, ldy, -parts.upper[t * nu + s], parts.k_matrix + s * ldy, row);
    for (int i = 0; i < ldy; ++i) row[i] /= parts.upper[t * nu + t];
  }
  // M_yy - A' K - K' S with A = M_ay, S = A - M_aa K.
  for (int t = 0; t < rank; ++t) {
    copy(m + t * ld, rank, parts.m_aa + t * nu);
    copy_padded(m + t * ld + rank, ny, a + t * ldy);
    double* s = parts.s_matrix + t * ldy;
    copy(a + t * ldy, ldy, s);
    for (int i = 0; i < rank; ++i) add(0, ldy, -m[t * ld + i], parts.k_matrix + i * ldy, s);
  }
  clear(memory.reduced, ldy * ldy);
  for (int j = 0; j < ny; ++j) copy(m + (rank + j) * ld + rank, ny, memory.reduced + j * ldy);
  add_products<true>(memory.reduced, ldy, a, parts.k_matrix, rank);
  add_products<true>(memory.reduced, ldy, parts.k_matrix, parts.s_matrix, rank);
}

/// The elimination of a right-hand side: c of the constraints (changed), m of the gradient (permuted; y from `rank`
/// on).
void eliminate_vector(const StageFactor& factor, double* c, double* m) {
  const int rank = factor.rank, ny = factor.nu + factor.nx - rank, ldy = padded(ny), nu = factor.nu;
  const Elimination parts = parts_of(factor);
  for (int t = 0; t < rank; ++t) {
    swap(c[t], c[static_cast<int>(parts.rows[t])]);
    swap(m[t], m[static_cast<int>(parts.columns[t])]);
  }
  for (int t = 0; t < rank; ++t)
    for (int i = t + 1; i < factor.gamma; ++i) c[i] -= parts.lower[t * factor.most + i] * c[t];
  for (int t = rank - 1; t >= 0; --t) {
    double sum = c[t];
    for (int s = t + 1; s < rank; ++s) sum -= parts.upper[t * nu + s] * parts.k[s];
    parts.k[t] = sum / parts.upper[t * nu + t];
  }
  copy(c + rank, factor.gamma - rank, parts.h);
  for (int t = 0; t < rank; ++t)
    for (int i = 0; i < ny; ++i)
      m[rank + i] -= parts.k_matrix[t * ldy + i] * m[t] + parts.s_matrix[t * ldy + i] * parts.k[t];
  for (int t = 0; t < rank; ++t) {
    parts.m_a[t] = m[t];
    for (int s = 0; s < rank; ++s) parts.m_a[t] -= parts.m_aa[s * nu + t] * parts.k[s];
  }
}

/// z of y, which starts at z + rank; and the multipliers of C z + c = 0, whose last gamma - rank are known.
void substitute(const StageFactor& factor, double* z, double* multipliers) {
  const int rank = factor.rank, ny = factor.nu + factor.nx - rank, ldy = padded(ny), nu = factor.nu;
  const Elimination parts = parts_of(factor);
  const double* y = z + rank;
  // (M z + m)_a + U' mu = 0, then L' nu = mu.
  for (int t = 0; t < rank; ++t) {
    double control = parts.k[t], gradient = parts.m_a[t];
    for (int i = 0; i < ny; ++i) {
      control += parts.k_matrix[t * ldy + i] * y[i];
      gradient += parts.s_matrix[t * ldy + i] * y[i];
    }
    z[t] = -control;
    for (int s = 0; s < t; ++s) gradient += parts.upper[s * nu + t] * multipliers[s];
    multipliers[t] = -gradient / parts.upper[t * nu + t];
  }
  for (int t = rank - 1; t >= 0; --t)
    for (int i = t + 1; i < factor.gamma; ++i) multipliers[t] -= parts.lower[t * factor.most + i] * multipliers[i];
  for (int t = rank - 1; t >= 0; --t) {
    swap(multipliers[t], multipliers[static_cast<int>(parts.rows[t])]);
    swap(z[t], z[static_cast<int>(parts.columns[t])]);
  }
}

}  // namespace
}  // namespace robotraj::native
