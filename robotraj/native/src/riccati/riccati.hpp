// Newton's system of a stagewise program by a Riccati recursion that uses the sparsity of the dynamics: its stages as the
// inner loops read them, numbers in place, patterns that equal stages share.
//
// Symmetric matrices and factors are kept in trapezoids. The n rows are padded to a multiple of kBlock, and column j
// begins at row 8 (j / 8). So every column starts where a vector register may be loaded, and little more than the lower
// triangle goes through memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace robotraj::native {

static constexpr int kBlock = 8;

static constexpr int padded(int n) { return (n + kBlock - 1) / kBlock * kBlock; }

/// Where column j of a trapezoid begins, moved so that row i is at `column_of(j, ld) + i`.
static constexpr int column_of(int j, int ld) {
  const int b = j / kBlock;
  return kBlock * b * ld - kBlock * kBlock / 2 * b * (b - 1) + (j - kBlock * b) * (ld - kBlock * b) - kBlock * b;
}

/// Numbers in the first `columns` columns of a trapezoid.
static constexpr int trapezoid(int columns, int ld) { return column_of(columns, ld) + columns / kBlock * kBlock; }

/// Rows of a Jacobian: "wide" ones kept whole, `ld` numbers each, then the entries of "thin" ones.
struct RowsView {
  int wide_count, thin_count;
  const std::int32_t* wide;     ///< their numbers
  const std::int32_t* thin;     ///< their numbers
  const std::int32_t* starts;   ///< of the thin rows' entries, thin_count + 1
  const std::int32_t* columns;  ///< of the thin rows' entries
  const double* values;
};

/// One stage: u first, then x; n = nu + nx.
struct StageView {
  int nu, nx, next;  ///< controls, states, states of the next stage (0 at the last one)
  RowsView dynamics, equalities, inequalities;
  int equality_count, inequality_count;
  const double* hessian;  ///< trapezoid of n columns
};

/// Numbers of a stage in vectors over all stages.
struct StageVectors {
  const double *f, *dynamics, *equalities, *inequalities;  ///< right-hand side: gradient and residuals of the rows
  const double *dx, *de, *ds;                              ///< damping; `de` may be null
  double *z, *lam_dynamics, *lam_equalities, *lam_inequalities;
};

/// Results of the recursion for a stage.
///
/// The constraints of a stage are C z + c = 0, its own equalities and those that the next stage could not meet by its
/// controls. Gaussian elimination with full pivoting solves `rank` of them for as many controls,
/// u_a = -(K y + k), y = (u_b, x), and leaves H x + h = 0 to the stage before.
struct StageFactor {
  double* l;            ///< trapezoid of L, nb columns of nb + nx rows: 0 on the diagonal
  double* diagonal;     ///< 1 / diagonal of L, nb
  double* step;         ///< L^-1 m_u, nb
  double* p;            ///< gradient of the cost to go, padded(nx)
  double* cost;         ///< trapezoid of its Hessian P, nx columns
  double* elimination;  ///< see `parts_of`; memory for as many constraints as there can be
  int nu, nx, most;     ///< controls, states, most constraints
  int gamma, rank;
};

/// Parts of `StageFactor::elimination`.
struct Elimination {
  double* lower;           ///< multipliers of the elimination, by columns of `most`
  double* upper;           ///< U, by columns of nu
  double* k_matrix;        ///< K, rank rows of padded(nu + nx)
  double* s_matrix;        ///< S = M_ay - M_aa K, rank rows of padded(nu + nx)
  double* m_aa;            ///< M of the eliminated controls, by columns of nu
  double* m_a;             ///< its gradient at y = 0, rank
  double* k;               ///< rank
  double* h_matrix;        ///< H, gamma - rank rows of padded(nx)
  double* h;               ///< gamma - rank
  double *rows, *columns;  ///< the row and the column that step t swapped with row and column t, rank
};

static constexpr std::size_t numbers(int rows, int columns) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
}

/// Numbers that the elimination of up to `most` constraints takes.
static constexpr std::size_t elimination_size(int most, int nu, int nx) {
  return most == 0 ? 0
                   : numbers(most, nu) + 2 * numbers(nu, nu) + 2 * numbers(nu, padded(nu + nx)) + 2 * numbers(nu, 1) +
                         numbers(most, padded(nx)) + numbers(most, 1) + 2 * numbers(nu, 1);
}

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
