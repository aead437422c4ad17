// Newton's step where rows are relaxed by slacks p, n >= 0 of their own: c(x) - p + n.
#include <algorithm>
#include <cmath>

#include "newton.hpp"

namespace robotraj::interior_point {

/// With w = 1 / (delta_w + z / d) for a slack d with multiplier z, and its slope g = f + c / d,
///
///     dp = w_p (dlam - g_p),   dn = w_n (-dlam - g_n),
///
/// so a row takes w_p + w_n in its relaxation and w_p g_p - w_n g_n in its residual.
void Newton::reduce_elastic(const Side& side) {
  const int first = own_slacks_;
  for (int i = 0; i < 2 * relaxed_; ++i) {
    const int k = first + i;
    elastic_inverse_[i] = 1.0 / (damping_s_[k] + lower_duals_[k] / below_[k]);
    elastic_slope_[i] = side.s[k] + side.lower[k] / below_[k];
  }
  const int start = problem_.layout().equality_rows;
  std::copy_n(side.rows, problem_.rows(), elastic_rows_);
  for (int i = 0; i < relaxed_; ++i) {
    const int n = relaxed_ + i;
    elastic_relaxation_[i] = relaxation_[i] + elastic_inverse_[i] + elastic_inverse_[n];
    elastic_rows_[start + i] += elastic_inverse_[i] * elastic_slope_[i] - elastic_inverse_[n] * elastic_slope_[n];
  }
}

void Newton::recover_elastic(const Side& side, const Vectors& step) const {
  const double* lam = step.rows + problem_.layout().equality_rows;
  for (int i = 0; i < 2 * relaxed_; ++i) {
    const int k = own_slacks_ + i;
    const double towards = i < relaxed_ ? lam[i] : -lam[i - relaxed_];
    step.s[k] = elastic_inverse_[i] * (towards - elastic_slope_[i]);
    step.lower[k] = -(side.lower[k] + lower_duals_[k] * step.s[k]) / below_[k];
    step.upper[k] = 0.0;
  }
}

double Newton::elastic_residual(const Side& side, const Vectors& step, const Left& left) const {
  const double* lam = step.rows + problem_.layout().equality_rows;
  double most = 0.0;
  for (int i = 0; i < 2 * relaxed_; ++i) {
    const int k = own_slacks_ + i;
    const double towards = i < relaxed_ ? lam[i] : -lam[i - relaxed_];
    left.slacks.s[k] = side.s[k] + damping_s_[k] * step.s[k] - towards - step.lower[k];
    left.slacks.lower[k] = side.lower[k] + lower_duals_[k] * step.s[k] + below_[k] * step.lower[k];
    left.slacks.upper[k] = 0.0;
    most = std::max({most, std::abs(left.slacks.s[k]), std::abs(left.slacks.lower[k])});
  }
  double* row = left.stages.equalities;
  for (int i = 0; i < relaxed_; ++i) {
    row[i] += step.s[own_slacks_ + relaxed_ + i] - step.s[own_slacks_ + i];
    most = std::max(most, std::abs(row[i]));
  }
  return most;
}

}  // namespace robotraj::interior_point
