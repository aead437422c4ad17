// The problem of the restoration phase: the least violation near the point where the line search gave up.
#pragma once

#include "problem.hpp"

namespace robotraj::interior_point {

/// minimise rho sum(p + n) + zeta / 2 |D_R (x - x_R)|^2  subject to  c(x, s) - p + n = 0,  p, n >= 0,
///
/// with D_R = diag(1 / max(1, |x_R|)) and zeta = sqrt(mu). Dynamics stay as they are. A state that follows from the
/// stage before is free, so their rows are of full rank and can always be met. Slacks are [s, p, n]. Source: the paper,
/// section 3.3.
class Feasibility final : public Problem {
 public:
  static constexpr double rho = 1000.0;

  explicit Feasibility(ProgramProblem& original);

  /// Rows that are relaxed: all but the dynamics, which come first.
  int relaxed() const { return rows() - layout().equality_rows; }
  int first_p() const { return layout().slacks; }
  int first_n() const { return layout().slacks + relaxed(); }
  /// Sets x_R, and the bounds of s as the original problem has them.
  void start_from(const double* x);

  bool elastic() const override { return true; }
  double objective(const double* x, const double* s) override;
  void gradient(const double* x, const double* s, double* of_x, double* of_s) override;
  void residual(const double* x, const double* s, double* out) override;
  void add_slack_product(const double* lam, double* out) const override;
  void jacobian(const double* x, StageValues& values) override { original_.jacobian(x, values); }
  void hessian(const double* x, const double* lam, bool convex, StageValues& values) override {
    original_.row_hessian(x, lam, convex, values);
  }
  bool saturates() const override { return original_.saturates(); }
  const double* damping() const override { return damping_.data(); }
  void set_barrier(double mu) override;

 private:
  ProgramProblem& original_;
  Numbers reference_, weights_, damping_;  // x_R, D_R^2, zeta D_R^2
};

}  // namespace robotraj::interior_point
