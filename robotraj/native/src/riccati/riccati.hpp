// Newton's system of a stagewise program by a Riccati recursion that uses the sparsity of the dynamics.
#pragma once

#include "stage_system.hpp"

namespace robotraj::native {

enum class Pivots { good, indefinite, dependent };

/// Least sizes of pivots.
struct RiccatiOptions {
  double lu_tolerance = 1e-5;     ///< entries below it are no pivots of the constraints' elimination
  double pivot_tolerance = 1e-6;  ///< Cholesky pivots below this part of their diagonal are not positive
};

/// Memory that a stage works in, as large as the largest stage needs; aligned to kBlock numbers.
struct RiccatiMemory {
  double *matrix, *reduced;  ///< M by columns, and M after the elimination of constraints
  double* cost;              ///< P of the next stage, full
  double* constraints;       ///< C, rows of padded(n)
  double *first, *second;    ///< products in between
  double* vector;            ///< 8 vectors of `length`
  int length;
};

/// Residuals of a stage's equations.
struct StageResidual {
  double *gradient, *dynamics, *equalities, *inequalities;
};

/// The recursion's inner loops; `next` is the stage after, null at the last one.
struct RiccatiKernels {
  Pivots (*factorise_stage)(const StageView& stage, const StageVectors& vectors, const StageFactor* next,
                            const RiccatiOptions& options, RiccatiMemory& memory, StageFactor& factor);
  Pivots (*factorise_start)(const StageFactor& first, const RiccatiOptions& options, RiccatiMemory& memory,
                            StageFactor& factor);
  void (*backward_stage)(const StageView& stage, const StageVectors& vectors, const StageFactor* next,
                         RiccatiMemory& memory, StageFactor& factor);
  void (*backward_start)(const StageFactor& first, RiccatiMemory& memory, StageFactor& factor);
  /// `left` holds the multipliers of the constraints that the stage left to the one before; then those of the next.
  void (*forward_stage)(const StageView& stage, const StageVectors& vectors, const StageFactor& factor,
                        const StageFactor* next, double* next_state, double* left, RiccatiMemory& memory);
  void (*forward_start)(const StageFactor& factor, double* state, double* left, RiccatiMemory& memory);

  double (*residual_stage)(const StageView& stage, const StageVectors& vectors, const double* before,
                           const double* next_state, const StageResidual& residual, RiccatiMemory& memory);

  void (*transposed_times)(const StageView& stage, const double* dynamics, const double* equalities,
                           const double* inequalities, double* out, double* memory);
};

/// The fastest that this processor runs.
const RiccatiKernels& riccati_kernels_of();

}  // namespace robotraj::native
