// A stage's part of the Riccati recursion: matrices, for one kind of processor.
#pragma once

#include "riccati_elimination.hpp"

namespace robotraj::native {
namespace {

ROBOTRAJ_INLINE void invert(const double* x, int n, double* out) {
  int i = 0;
  for (; i + kStep <= n; i += kStep) store(out + i, 1.0 / load(x + i));
  for (; i < n; ++i) out[i] = 1.0 / x[i];
}

/// M += sum_r weight_r rows_r' rows_r, in the lower triangle.
void add_weighted(const RowsView& rows, const double* weight, int ld, double* m, double* scaled) {
  const double* value = rows.values;
  for (int r = 0; r < rows.wide_count; ++r) {
    const double factor = weight[rows.wide[r]];
    for (int i = 0; i < ld; i += kStep) store(scaled + r * ld + i, factor * load(value + r * ld + i));
  }
  add_products(m, ld, value, scaled, rows.wide_count);
  value += rows.wide_count * ld;
  for (int r = 0; r < rows.thin_count; ++r) {
    const double factor = weight[rows.thin[r]];
    // Columns ascend, so the second entry is at or below the first.
    for (int a = rows.starts[r]; a < rows.starts[r + 1]; ++a) {
      double* column = m + rows.columns[a] * ld;
      const double first = factor * value[a];
      for (int b = a; b < rows.starts[r + 1]; ++b) column[rows.columns[b]] += first * value[b];
    }
  }
}

/// M += [B A]' P [B A], P full and symmetric with `next` columns of padded(next).
void add_cost_to_go(const StageView& stage, int ld, RiccatiMemory& memory) {
  const int ldp = padded(stage.next), n = stage.nu + stage.nx;
  const RowsView& rows = stage.dynamics;
  const double *p = memory.cost, *thin = rows.values + rows.wide_count * ld;
  double *by_columns = memory.first, *by_rows = memory.second, *m = memory.matrix;
  clear(by_columns, n * ldp);
  for (int r = 0; r < rows.wide_count; ++r)
    for (int j = 0; j < n; ++j) add(0, ldp, rows.values[r * ld + j], p + rows.wide[r] * ldp, by_columns + j * ldp);
  for (int r = 0; r < rows.thin_count; ++r)
    for (int e = rows.starts[r]; e < rows.starts[r + 1]; ++e)
      add(0, ldp, thin[e], p + rows.thin[r] * ldp, by_columns + rows.columns[e] * ldp);
  clear(by_columns + n * ldp, (ld - n) * ldp);
  transpose(by_columns, ldp, ld, by_rows, ld);
  for (int r = 0; r < rows.wide_count; ++r) copy(by_rows + rows.wide[r] * ld, ld, by_columns + r * ld);
  add_products(m, ld, by_columns, rows.values, rows.wide_count);
  for (int r = 0; r < rows.thin_count; ++r)
    for (int e = rows.starts[r]; e < rows.starts[r + 1]; ++e) {
      const int j = rows.columns[e];
      add(j / kBlock * kBlock, ld, thin[e], by_rows + rows.thin[r] * ld, m + j * ld);
    }
}

/// Cholesky's L of the first nb columns of M (rows to ld) into the trapezoid, and 1 / its diagonal.
/// False where a pivot has lost all but `tolerance` of its diagonal.
bool cholesky(double* m, int ld, int nb, double tolerance, double* l, double* diagonal) {
  for (int j = 0; j < nb; ++j) {
    double* column = m + j * ld;
    const int first = j / kBlock * kBlock;
    const double before = column[j];
    for (int i = first; i < ld; i += kStep) {
      Pack even = load(column + i), odd{};
      int k = 0;
      for (; k + 1 < j; k += 2) {
        even -= load(m + k * ld + i) * m[k * ld + j];
        odd -= load(m + (k + 1) * ld + i) * m[(k + 1) * ld + j];
      }
      if (k < j) even -= load(m + k * ld + i) * m[k * ld + j];
      store(column + i, even + odd);
    }
    const double pivot = column[j];
    if (pivot <= tolerance * (before > 0.0 ? before : -before) || pivot <= 0.0) return false;
    const double inverse = 1.0 / __builtin_sqrt(pivot);
    diagonal[j] = inverse;
    double* kept = l + column_of(j, ld);
    for (int i = first; i < ld; i += kStep) {
      const Pack value = inverse * load(column + i);
      store(column + i, value);
      store(kept + i, value);
    }
    for (int i = first; i <= j; ++i) kept[i] = 0.0;
  }
  return true;
}

/// memory.cost = M_xx - L_xu L_xu', full and symmetric; M has ld rows, x from nb on. Its trapezoid goes to `kept`.
void reduce_cost(const double* m, int ld, int nb, int nx, RiccatiMemory& memory, double* kept) {
  const int ldp = padded(nx);
  double *p = memory.cost, *rows = memory.first;
  // What is copied beyond the last row belongs to the next column.
  const auto take = [=](const double* from, double* to, int first) {
    for (int i = first; i < ldp; i += kStep) store(to + i, load(from + i));
    for (int i = nx; i < ldp; ++i) to[i] = 0.0;
  };
  for (int j = 0; j < nx; ++j) take(m + (nb + j) * ld + nb, p + j * ldp, j / kBlock * kBlock);
  for (int k = 0; k < nb; ++k) take(m + k * ld + nb, rows + k * ldp, 0);
  add_products<true>(p, ldp, rows, rows, nb);
  for (int j = 0; j < nx; ++j) {
    double* column = kept + column_of(j, ldp);
    for (int i = j / kBlock * kBlock; i < j; ++i) column[i] = 0.0;
    for (int i = j; i < ldp; ++i) column[i] = p[j * ldp + i];
    for (int i = j + 1; i < nx; ++i) p[i * ldp + j] = p[j * ldp + i];
  }
}

/// Eliminates the controls from M: those of the constraints, then the rest. The results are in `factor`.
Pivots divide(int gamma, const RiccatiOptions& options, RiccatiMemory& memory, StageFactor& factor) {
  const int nu = factor.nu, nx = factor.nx;
  double* m = memory.matrix;
  int ld = padded(nu + nx);
  factor.gamma = gamma;
  factor.rank = 0;
  if (gamma > 0) {
    eliminate(gamma, options.lu_tolerance, memory, factor);
    if (gamma - factor.rank > nx) return Pivots::dependent;
    if (factor.rank > 0) {
      m = memory.reduced;
      ld = padded(nu + nx - factor.rank);
    }
  }
  if (!cholesky(m, ld, nu - factor.rank, options.pivot_tolerance, factor.l, factor.diagonal)) return Pivots::indefinite;
  reduce_cost(m, ld, nu - factor.rank, nx, memory, factor.cost);
  return Pivots::good;
}

/// One stage backwards: the matrices. `next` is the stage after, null at the last one.
Pivots factorise_stage(const StageView& stage, const StageVectors& vectors, const StageFactor* next,
                       const RiccatiOptions& options, RiccatiMemory& memory, StageFactor& factor) {
  const int n = stage.nu + stage.nx, ld = padded(n);
  double *m = memory.matrix, *weights = memory.vector;
  for (int j = 0; j < n; ++j) {
    const double* column = stage.hessian + column_of(j, ld);
    for (int i = j / kBlock * kBlock; i < ld; i += kStep) store(m + j * ld + i, load(column + i));
    m[j * ld + j] += vectors.dx[j];
  }
  if (next) add_cost_to_go(stage, ld, memory);
  invert(vectors.ds, stage.inequality_count, weights);
  add_weighted(stage.inequalities, weights, ld, m, memory.first);
  if (vectors.de) {
    invert(vectors.de, stage.equality_count, weights);
    add_weighted(stage.equalities, weights, ld, m, memory.first);
    return divide(0, options, memory, factor);
  }
  const int left = next ? next->gamma - next->rank : 0, gamma = stage.equality_count + left;
  if (gamma > n) return Pivots::dependent;
  if (gamma > 0) gather_constraints(stage, next, memory.constraints);
  return divide(gamma, options, memory, factor);
}

/// Solves for the first state: M = P_0, with the constraints that the first stage could not meet by its controls.
Pivots factorise_start(const StageFactor& first, const RiccatiOptions& options, RiccatiMemory& memory,
                       StageFactor& factor) {
  const int ld = padded(first.nx), gamma = first.gamma - first.rank;
  copy(memory.cost, ld * ld, memory.matrix);
  if (gamma > 0) copy(parts_of(first).h_matrix, gamma * ld, memory.constraints);
  return divide(gamma, options, memory, factor);
}

}  // namespace
}  // namespace robotraj::native
