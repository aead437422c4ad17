// Residuals of a stage's equations, for one kind of processor.
#pragma once

#include "riccati.hpp"
#include "stage_vectors.hpp"

namespace robotraj::native {
namespace {

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

}  // namespace
}  // namespace robotraj::native
