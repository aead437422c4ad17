// Newton's step of the primal-dual system, by the recursion over stages and passes over the slacks.
#pragma once

#include "interior_point/problem/iterate.hpp"

namespace robotraj::interior_point {

/// A right-hand side; see `Newton`.
struct Side {
  const double *x, *rows, *s, *lower, *upper;
};

enum class Solved { good, indefinite, dependent, inaccurate, invalid };

/// Solves, with W the Hessian of the Lagrangian, S_l and S_u the slacks' distances from their bounds,
///
///     (W + delta_w) dx + A' dlam              = -side.x
///     A dx + (dc / ds) ds - delta_c dlam      = -side.rows
///     delta_w ds + (dc / ds)' dlam - dz_l + dz_u = -side.s
///     Z_l ds + S_l dz_l                       = -side.lower
///     -Z_u ds + S_u dz_u                      = -side.upper
///
/// the paper's equation 9 with slacks. Slacks and their multipliers are eliminated, and the rest is solved by stages.
/// The solution is refined while its residual falls and is above 1e-8 and 1e-5 of the right-hand side: Newton's method
/// converges as fast with steps that leave a small part of it (Dembo, Eisenstat and Steihaug, SIAM J. Numer. Anal. 19,
/// 1982). Dynamics take no delta_c: they are of full rank.
class Newton : private native::Along {
 public:
  explicit Newton(Problem& problem);

  native::RiccatiOptions options;

  /// The Hessian of the Lagrangian, evaluated by the caller.
  StageValues& hessian() { return hessian_; }
  Solved solve(Iterate& iterate, const Side& side, double delta_w, double delta_c, const Vectors& step);
  /// The same with W = 0, delta_w = 1 and Z_l = Z_u = 0, which finds the multipliers of least squares,
  /// min |side.x + A' lam|^2 + |side.s + (dc / ds)' lam|^2.
  Solved least_squares(Iterate& iterate, const Side& side, double delta_c, const Vectors& step);
  /// With the factors of the last call of `solve`.
  Solved solve_again(Iterate& iterate, const Side& side, const Vectors& step);

 private:
  /// Residuals of some stages, one after the other.
  struct Left {
    native::StageResidual stages;
    native::SlackStep slacks;
  };

  void make_part();
  void set_damping(double delta_w, double delta_c);
  Left whole(const Vectors& step) const;
  int first_slack(std::size_t stage) const;
  native::NewtonSystem system(const Side& side, bool reduced, const Vectors& step) const;
  native::SlackSystem slacks(int first, const double* relaxation) const;
  // All of them for stages [begin, end).
  void reduce(const Side& side, std::size_t begin, std::size_t end);
  void recover(const Side& side, const Vectors& step, std::size_t begin, std::size_t end);
  double residual(const Side& side, const Vectors& step, std::size_t begin, std::size_t end, const Left& left);
  void before(std::size_t begin, std::size_t end) override { reduce(side_, begin, end); }
  void after(std::size_t begin, std::size_t end) override;
  // The slacks p and n of relaxed rows.
  void reduce_elastic(const Side& side);
  void recover_elastic(const Side& side, const Vectors& step) const;
  double elastic_residual(const Side& side, const Vectors& step, const Left& left) const;

  void take(Iterate& iterate, const Side& side, const Vectors& step);
  Solved factorise();
  void solve_reduced(const Side& side, const Vectors& step);
  double size_of(const Side& side) const;
  bool finite(const Vectors& step) const { return run_.finite(step.x, size_of_step_); }
  Solved refine();

  Problem& problem_;
  const VectorKernels& run_;
  std::unique_ptr<native::NewtonSolver> solver_;
  StageValues hessian_;
  int own_slacks_, relaxed_, size_of_step_;
  Packs memory_, part_memory_, elastic_memory_;
  double *inverse_, *gradient_, *weights_, *slack_rows_, *damping_x_, *damping_s_, *relaxation_;
  double *elastic_inverse_ = nullptr, *elastic_slope_ = nullptr, *elastic_relaxation_ = nullptr,
         *elastic_rows_ = nullptr;
  Left part_{};
  std::unique_ptr<Room> residual_, correction_, better_;  // made when a solution is first refined
  double delta_w_ = -1.0, delta_c_ = -1.0;
  bool relaxes_ = false;
  // The system that is solved now.
  const StageValues* jacobian_ = nullptr;
  const double *below_ = nullptr, *above_ = nullptr, *lower_duals_ = nullptr, *upper_duals_ = nullptr;
  Side side_{};
  Vectors step_{};
  double left_ = 0.0, size_ = 0.0;
};

}  // namespace robotraj::interior_point
