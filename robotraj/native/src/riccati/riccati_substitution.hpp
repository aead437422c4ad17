// A stage's part of the Riccati recursion: right-hand sides, backwards and forwards, and residuals, for one kind of
// processor.
#pragma once

#include "riccati_elimination.hpp"
#include "riccati_matrices.hpp"

namespace robotraj::native {
namespace {

/// Gradient m (in memory.vector's first part) and residuals c to L^-1 m_u, p and, where constraints are left, h.
void finish_backward(double* c, double* m, StageFactor& factor) {
  const int nb = factor.nu - factor.rank, ldy = padded(nb + factor.nx);
  if (factor.gamma > 0) {
    eliminate_vector(factor, c, m);
    for (int i = 0; i < nb + factor.nx; ++i) m[i] = m[i + factor.rank];
  }
  for (int j = 0; j < nb; ++j) {
    factor.step[j] = m[j] * factor.diagonal[j];
    add(j / kBlock * kBlock, ldy, -factor.step[j], factor.l + column_of(j, ldy), m);
  }
  copy_padded(m + nb, factor.nx, factor.p);
}

/// One stage backwards: the right-hand side.
void backward_stage(const StageView& stage, const StageVectors& vectors, const StageFactor* next, RiccatiMemory& memory,
                    StageFactor& factor) {
  const int n = stage.nu + stage.nx, ld = padded(n), length = memory.length;
  double *m = memory.vector, *c = m + length, *weighted = c + length, *b = weighted + length, *slope = b + length;
  copy_padded(vectors.f, n, m);
  if (next) {
    copy_padded(vectors.dynamics, stage.next, b);
    copy(next->p, padded(stage.next), slope);
    add_symmetric(next->cost, stage.next, b, slope);
    add_transposed(stage.dynamics, ld, slope, m);
  }
  divide_by(vectors.inequalities, vectors.ds, stage.inequality_count, weighted);
  add_transposed(stage.inequalities, ld, weighted, m);
  if (vectors.de) {
    divide_by(vectors.equalities, vectors.de, stage.equality_count, weighted);
    add_transposed(stage.equalities, ld, weighted, m);
  } else if (factor.gamma > 0) {
    copy(vectors.equalities, stage.equality_count, c);
    if (next) {
      const Elimination parts = parts_of(*next);
      const int ldp = padded(stage.next);
      for (int i = 0; i < next->gamma - next->rank; ++i)
        c[stage.equality_count + i] = parts.h[i] + dot(0, ldp, parts.h_matrix + i * ldp, b);
    }
  }
  finish_backward(c, m, factor);
}

void backward_start(const StageFactor& first, RiccatiMemory& memory, StageFactor& factor) {
  double *m = memory.vector, *c = m + memory.length;
  copy(first.p, padded(first.nx), m);
  if (factor.gamma > 0) copy(parts_of(first).h, factor.gamma, c);
  finish_backward(c, m, factor);
}

/// z (padded) of its last nx numbers, and the multipliers of the constraints.
void find_controls(const StageFactor& factor, const double* state, const double* left, double* z, double* y,
                   double* multipliers) {
  const int nb = factor.nu - factor.rank, ny = nb + factor.nx, ldy = padded(ny);
  clear(y, ldy);
  copy(state, factor.nx, y + nb);
  // The states' part of L' y first, all columns at once; then u from the last one on, by rows of L.
  const int n = factor.nu + factor.nx;
  double* sum = z;
  for (int j = 0; j < nb; ++j) sum[j] = factor.step[j] + dot(j / kBlock * kBlock, ldy, factor.l + column_of(j, ldy), y);
  for (int j = nb - 1; j >= 0; --j) {
    const double control = y[j] = -factor.diagonal[j] * sum[j];
    for (int i = 0; i < j; ++i) sum[i] += factor.l[column_of(i, ldy) + j] * control;
  }
  clear(z, padded(n));
  copy(y, ny, z + factor.rank);
  if (factor.gamma == 0) return;
  copy(left, factor.gamma - factor.rank, multipliers + factor.rank);
  substitute(factor, z, multipliers);
}

void forward_stage(const StageView& stage, const StageVectors& vectors, const StageFactor& factor,
                   const StageFactor* next, double* next_state, double* left, RiccatiMemory& memory) {
  const int n = stage.nu + stage.nx, ld = padded(n), length = memory.length;
  double *z = memory.vector, *y = z + length, *multipliers = y + length, *rows = multipliers + length,
         *state = rows + length, *slope = state + length;
  find_controls(factor, vectors.z + stage.nu, left, z, y, multipliers);
  copy(z, stage.nu, vectors.z);
  if (vectors.de) {
    times(stage.equalities, ld, z, rows);
    for (int i = 0; i < stage.equality_count; ++i) rows[i] += vectors.equalities[i];
    divide_by(rows, vectors.de, stage.equality_count, vectors.lam_equalities);
  } else {
    copy(multipliers, stage.equality_count, vectors.lam_equalities);
  }
  times(stage.inequalities, ld, z, rows);
  for (int i = 0; i < stage.inequality_count; ++i) rows[i] += vectors.inequalities[i];
  divide_by(rows, vectors.ds, stage.inequality_count, vectors.lam_inequalities);
  if (!next) return;
  times(stage.dynamics, ld, z, state);
  for (int i = 0; i < stage.next; ++i) state[i] += vectors.dynamics[i];
  for (int i = stage.next; i < padded(stage.next); ++i) state[i] = 0.0;
  copy(state, stage.next, next_state);
  copy(next->p, padded(stage.next), slope);
  add_symmetric(next->cost, stage.next, state, slope);
  const int count = next->gamma - next->rank;
  if (count > 0) {
    copy(multipliers + stage.equality_count, count, left);
    const double* h = parts_of(*next).h_matrix;
    for (int i = 0; i < count; ++i, h += padded(stage.next)) add(0, padded(stage.next), left[i], h, slope);
  }
  copy(slope, stage.next, vectors.lam_dynamics);
}

void forward_start(const StageFactor& factor, double* state, double* left, RiccatiMemory& memory) {
  double *z = memory.vector, *y = z + memory.length, *multipliers = y + memory.length;
  find_controls(factor, nullptr, nullptr, z, y, multipliers);
  copy(z, factor.nu, state);
  copy(multipliers, factor.gamma, left);
}

/// out = x + y, n numbers; the larger of `most` and all of their magnitudes.
ROBOTRAJ_INLINE double add_and_measure(const double* x, const double* y, int n, double most, double* out) {
  for (int i = 0; i < n; ++i) {
    out[i] = x[i] + y[i];
    const double size = out[i] < 0.0 ? -out[i] : out[i];
    most = size > most ? size : most;
  }
  return most;
}

/// gradient = f + (H + D_x) z + A' lam and rows = g + A z - D_e lam of one stage, without the inequalities' D_e.
/// `before` are the multipliers of the dynamics that give the stage's states, null at the first one.
/// Returns the greatest of both, the inequalities' rows left out.
double residual_stage(const StageView& stage, const StageVectors& vectors, const double* before,
                      const double* next_state, const StageResidual& residual, RiccatiMemory& memory) {
  const int n = stage.nu + stage.nx, ld = padded(n), length = memory.length;
  double *z = memory.vector, *sum = z + length, *rows = sum + length;
  copy_padded(vectors.z, n, z);
  clear(sum, ld);
  for (int i = 0; i < n; ++i) sum[i] = vectors.dx[i] * z[i];
  add_symmetric(stage.hessian, n, z, sum);
  add_transposed(stage.dynamics, ld, vectors.lam_dynamics, sum);
  add_transposed(stage.equalities, ld, vectors.lam_equalities, sum);
  add_transposed(stage.inequalities, ld, vectors.lam_inequalities, sum);
  if (before)
    for (int i = 0; i < stage.nx; ++i) sum[stage.nu + i] -= before[i];
  double most = add_and_measure(vectors.f, sum, n, 0.0, residual.gradient);
  if (next_state) {
    times(stage.dynamics, ld, z, rows);
    for (int i = 0; i < stage.next; ++i) rows[i] -= next_state[i];
    most = add_and_measure(vectors.dynamics, rows, stage.next, most, residual.dynamics);
  }
  times(stage.equalities, ld, z, rows);
  if (vectors.de)
    for (int i = 0; i < stage.equality_count; ++i) rows[i] -= vectors.de[i] * vectors.lam_equalities[i];
  most = add_and_measure(vectors.equalities, rows, stage.equality_count, most, residual.equalities);
  times(stage.inequalities, ld, z, rows);
  add_and_measure(vectors.inequalities, rows, stage.inequality_count, 0.0, residual.inequalities);
  return most;
}

const RiccatiKernels riccati_kernels = {
    factorise_stage, factorise_start, backward_stage, backward_start,
    forward_stage,   forward_start,   residual_stage, transposed_times,
};

}  // namespace
}  // namespace robotraj::native
