// Options of a solve; names of the paper behind them.
//
// Waechter and Biegler, On the implementation of an interior-point filter line-search algorithm for large-scale
// nonlinear programming, Mathematical Programming 106 (2006), is "the paper" in this folder.
#pragma once

#include <limits>

namespace robotraj::interior_point {

struct Options {
  double tolerance = 1e-8;             ///< eps_tol, of the scaled error E_0
  double acceptable_tolerance = 1e-6;  ///< of an error that is good enough after `acceptable_iterations` in a row
  int acceptable_iterations = 15;
  double violation_tolerance = 1e-4;  ///< of the most violated row at a solution
  double objective_change = 0.0;      ///< relative one that ends a solve; see `Convergence`
  int max_iterations = 1000;          ///< those of the restoration phase included
  double processor_limit = std::numeric_limits<double>::infinity();  ///< processor seconds of the process

  double initial_barrier = 0.1;   ///< mu_0
  double barrier_factor = 10.0;   ///< kappa_eps: mu falls where E_mu <= kappa_eps mu
  double barrier_decrease = 0.2;  ///< kappa_mu
  double barrier_power = 1.5;     ///< theta_mu
  bool adaptive_barrier = false;  ///< mu from a predictor step while the error falls; see `Barrier`

  double bound_relaxation = 1e-8;  ///< bounds are widened by this share of max(1, |bound|)
  double bound_push = 1e-2;        ///< kappa_1: distance of the first slacks from their bounds
  double bound_fraction = 1e-2;    ///< kappa_2: the same as a share of the range

  double elimination_tolerance = 1e-5;  ///< entries below it are no pivots of the constraints' elimination
  double pivot_tolerance = 1e-14;       ///< Cholesky pivots below this share of their diagonal are not positive

  double first_correction = 1e-4;          ///< delta_w^0 of the Hessian's diagonal
  double correction_increase = 8.0;        ///< kappa_w^+
  double correction_decrease = 1.0 / 3.0;  ///< kappa_w^-
  double row_correction = 1e-6;            ///< delta_c where rows depend on each other, times mu^(1/4)
  double least_row_correction = 0.0;       ///< the same everywhere
};

}  // namespace robotraj::interior_point
