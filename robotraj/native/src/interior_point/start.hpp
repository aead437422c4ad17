// Start of a solve: slacks inside their bounds and multipliers, cold or from an earlier solution.
#pragma once

#include "run.hpp"

namespace robotraj::interior_point {

/// Multipliers of an earlier solution, of the objective as the problem has it.
struct Known {
  const double *rows, *lower, *upper;  ///< of the rows and of the slacks' bounds, the latter not negative
};

/// Slacks at d(x), moved into their bounds by kappa_1 max(1, |bound|) or, between two bounds, by kappa_2 of the range
/// at most; multipliers of the bounds 1; those of the rows by least squares, zero where these exceed 1000.
/// Source: the paper, section 3.6.
void start_cold(Run& run, const double* x);

/// From multipliers. With a slack's distance d to a bound and that bound's multiplier z, both are moved onto
/// d z >= mu: a multiplier smaller than the distance grows, else the distance does. So a solution at mu starts where it
/// ended, and a bound that moved across its row starts at d = z = sqrt(mu) or beyond.
void start_warm(Run& run, const double* x, const Known& known);

/// Sets the rows' multipliers of the current iterate to those of least squares,
/// min |grad f + A' lam|^2 + |-lam - z_l + z_u|^2, to zero where any exceeds `most`.
void estimate_multipliers(Run& run, double most);

}  // namespace robotraj::interior_point
