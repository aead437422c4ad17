// Dense fronts of a symmetric indefinite matrix, and the elimination of their pivots.
#pragma once

namespace robotraj::native::ldl {

/// Rows of fronts are filled up to a multiple of it, so that packs end where columns do.
constexpr int kRowBlock = 8;
constexpr int padded_rows(int rows) { return (rows + kRowBlock - 1) / kRowBlock * kRowBlock; }

/// Pivots that are collected before the rest of a front is updated.
constexpr int kPanel = 24;

/// A front: a symmetric matrix whose first `candidates` rows have all their entries.
///
/// Only the lower triangle is read; the upper one may hold any numbers. Elimination leaves the columns of L in the
/// first ones, the Schur complement in the others.
struct Front {
  double* entries;  ///< column-major, `ld` numbers a column
  int ld;           ///< padded_rows(rows)
  int rows;
  int candidates;
  int* order;        ///< numbers of the rows in the matrix; swapped with them
  double* diagonal;  ///< of the inverse of D, a number a pivot
  double* off;       ///< beside it: not zero where a pivot has two rows, at the first of them
  double* memory;    ///< (kPanel + 2) ld numbers
};

struct PivotRule {
  double threshold;  ///< a pivot must not make multipliers larger than 1 / threshold
  double small;      ///< pivots below it are zero
  bool last;         ///< the last front, in which every candidate is eliminated
};

struct Pivots {
  int count, negative, zero;
};

/// Inner loops, for each kind of processor.
struct FrontKernels {
  Pivots (*eliminate)(Front& front, const PivotRule& rule);
  /// Adds a child's lower triangle of `count` rows, `step` numbers a column, to a front at `places`, ascending.
  void (*add)(const double* block, int step, int count, const int* places, double* entries, int ld);
  /// x := L^-1 x and x := L^-T x for `pivots` columns of L, x of all `ld` rows, zeros at the end.
  void (*forward)(const double* l, int ld, int pivots, double* x);
  void (*backward)(const double* l, int ld, int pivots, double* x);
};

}  // namespace robotraj::native::ldl
