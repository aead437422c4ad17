// How far an iterate is from a solution.
#pragma once

#include <deque>

#include "iterate.hpp"
#include "options.hpp"

namespace robotraj::interior_point {

/// E_mu = max(|grad L| / s_d, |c|, |S z - mu| / s_c), largest magnitudes, with
///
///     s_d = max(s_max, mean |(lam, z)|) / s_max,   s_c = max(s_max, mean |z|) / s_max,   s_max = 100.
///
/// Source: the paper, equation 5.
double error(Iterate& iterate, double mu);

/// The same without the rows' violation |c|.
double dual_error(Iterate& iterate, double mu);

/// mean |grad L| + mean |c| + mean |S z - mu|, the error of the primal-dual equations of the barrier problem.
double system_error(Iterate& iterate, double mu);

/// Mean of multiplier times distance over all bounds; 0 where there is none.
double mean_complementarity(Iterate& iterate);

/// `acceptable` after `acceptable_iterations` in a row with E_0 <= `acceptable_tolerance`.
enum class Converged { no, solved, acceptable };

/// Solved where E_0 <= eps_tol and no row is violated by more than `violation_tolerance`. The adaptive rule of the
/// barrier also needs products |S z| <= eps_tol / 10: it may arrive there with products that are still a hundred times
/// its parameter, and the objective is then off by their sum.
class Convergence {
 public:
  explicit Convergence(const Options& options) : options_(options) {}

  void reset() {
    acceptable_ = 0;
    objectives_.clear();
  }
  Converged check(Iterate& iterate);
  /// Whether the objective was within `objective_change` of itself for eight iterations, near the rows; to be asked once
  /// an iteration. Never where `objective_change` is 0.
  bool settled(Iterate& iterate);
  /// Whether the objective is within a hundredth of another one.
  bool is_near(Iterate& iterate, double objective) const;
  /// Whether products of distances and multipliers sum to more than `objective_change` of the objective, so that the
  /// problem of the present barrier parameter alone has settled.
  bool has_gap(Iterate& iterate) const;

 private:
  bool close(Iterate& iterate) const;

  const Options& options_;
  int acceptable_ = 0;
  std::deque<double> objectives_;  // of the last iterations
};

}  // namespace robotraj::interior_point
