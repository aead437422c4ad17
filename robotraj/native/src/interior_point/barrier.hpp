// Updates of the barrier parameter.
#pragma once

#include <deque>
#include <memory>

#include "run.hpp"

namespace robotraj::interior_point {

/// How often a step is centred, and for steps of how much more length.
struct Centring {
  int times;
  double longer;
};

/// Monotone: as soon as E_mu <= kappa_eps mu,
///
///     mu <- max(eps_tol / (min(kappa_eps, 100) + 1), min(kappa_mu mu, mu^theta_mu)),   (the paper, equations 6 and 7)
///
/// Adaptive: mu = sigma mean(z s), sigma = (mean(z s) after the step of mu = 0 / mean(z s))^3, as long as the error of
/// the optimality conditions falls below 0.9 of the largest of the last four; else monotone from 0.8 mean(z s) on, until
/// it does again. The step of the chosen mu also corrects the complementarity by the products of the changes in the step
/// of mu = 0, unless the bounds then shorten it to less than 0.9 of that step, or mu is the least one.
///
/// A step that the bounds shorten is centred up to four times for steps that are longer by 0.3, as long as it lengthens.
/// With a monotone parameter it is centred up to twice, for steps that are longer by 0.4, in programs without stages
/// alone, where the first parameter is at most 1e-2.
///
/// Sources: Nocedal, Waechter, Waltz, Adaptive barrier update strategies for nonlinear interior methods, SIAM J. Optim.
/// 19 (2009), sections 3 and 4; Mehrotra, On the implementation of a primal-dual interior point method, SIAM J. Optim.
/// 2 (1992), for the correction; Gondzio, Multiple centrality corrections in a primal-dual method for linear
/// programming, Computational Optimization and Applications 6 (1996), for the centring.
class Barrier {
 public:
  explicit Barrier(Run& run) : run_(run) {}

  void start(double mu);
  /// Before a step is computed. Returns whether the parameter changed.
  bool update();
  /// Lowers a parameter that falls monotonically although its problem is not solved; false where it does not fall.
  bool fall();
  /// Whether the next step chooses its parameter.
  bool is_free() const { return run_.options.adaptive_barrier && free_; }
  /// Makes the step of the current iterate, for a parameter that it chooses; false where there is no step.
  bool choose();
  /// Makes the step of the parameter that falls monotonically.
  bool follow();

 private:
  bool decrease();
  double least() const;
  bool second_order_step();
  void center(const Centring& how);

  Run& run_;
  std::unique_ptr<Room> before_;  // the step before it is centred
  bool free_ = true;
  std::deque<double> errors_;
};

}  // namespace robotraj::interior_point
