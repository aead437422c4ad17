// Vector operations of an interior-point iteration on all slacks, bounds and multipliers.
#pragma once

namespace robotraj::native {

/// Bounds of the slacks; infinite where there is none.
struct Bounds {
  const double *lower, *upper;
  int count;
};

/// Results of one pass over the slacks for the barrier.
struct DistanceSums {
  double mantissa, exponent;  ///< the product of all distances is mantissa 2^exponent
  double single;              ///< the sum of the distances of slacks with one bound
  bool regular;               ///< whether every distance is a positive normal number; if not, no product was formed
};

/// The part of Newton's system that belongs to the slacks s and the multipliers z_l, z_u of their bounds,
///
///     D s - lam - z_l + z_u = -f,   Z_l s + S_l z_l = -c_l,   -Z_u s + S_u z_u = -c_u.
struct SlackSystem {
  const double *below, *above, *lower_duals, *upper_duals;  ///< S_l, S_u, Z_l, Z_u
  const double *damping, *relaxation;                       ///< D, and D_e of the rows A x - s - D_e lam = -g
};
struct SlackSide {
  const double *s, *lower, *upper, *rows;  ///< f, c_l, c_u, g
};
struct SlackStep {
  double *s, *lower, *upper;
};

/// Functions of vectors that may stand anywhere and have any length.
struct VectorKernels {
  double (*largest)(const double* x, int n);       ///< max |x|, 0 for none; NaN is ignored
  double (*absolute_sum)(const double* x, int n);  ///< sum |x|
  bool (*finite)(const double* x, int n);
  void (*add)(const double* x, const double* y, int n, double* out);  ///< out = x + y

  /// below = s - lower and above = upper - s, 1 where there is no bound.
  DistanceSums (*distances)(const Bounds& bounds, const double* s, double* below, double* above);
  /// Gradient of mu (-sum log(distances) + kappa sum(distances of slacks with one bound)); `damping` is mu kappa.
  void (*barrier_gradient)(const Bounds& bounds, const double* below, const double* above, double mu, double damping,
                           double* out);
  /// Its product with ds.
  double (*barrier_slope)(const Bounds& bounds, const double* below, const double* above, double mu, double damping,
                          const double* ds);

  /// out = z distance - mu, 0 where there is no bound.
  void (*complementarity)(const double* bound, const double* z, const double* distance, double mu, int n, double* out);
  /// max |z distance - mu| of both bounds.
  double (*largest_complementarity)(const Bounds& bounds, const double* lower_duals, const double* below,
                                    const double* upper_duals, const double* above, double mu);
  /// The longest step, at most 1, that leaves (1 - tau) of every distance.
  double (*longest_step)(const Bounds& bounds, const double* below, const double* above, const double* ds, double tau);
  /// The same for multipliers that stay positive.
  double (*longest_dual_step)(const Bounds& bounds, const double* lower_duals, const double* lower_step,
                              const double* upper_duals, const double* upper_step, double tau);
  /// z between mu / (kappa distance) and kappa mu / distance, 0 where there is no bound.
  void (*clamp_duals)(const double* bound, const double* distance, double mu, double kappa, int n, double* z);

  /// Eliminates z, then s = inverse (lam - gradient): A x - weights lam = -rows is left.
  void (*reduce)(const SlackSystem& system, const SlackSide& side, int n, double* inverse, double* gradient,
                 double* weights, double* rows);
  void (*recover)(const SlackSystem& system, const SlackSide& side, const double* inverse, const double* gradient,
                  const double* lam, int n, const SlackStep& step);
  /// Residuals of the three equations of the slacks and their largest magnitude; rows += -s - D_e lam.
  double (*slack_residual)(const SlackSystem& system, const SlackSide& side, const SlackStep& step, const double* lam,
                           int n, const SlackStep& residual, double* rows);
};

/// The fastest that this processor runs.
const VectorKernels& vector_kernels_of();

/// Sum of the logarithms of the distances from `distances`; distance by distance where the product is not regular.
double log_sum(const DistanceSums& sums, const Bounds& bounds, const double* below, const double* above);

}  // namespace robotraj::native
