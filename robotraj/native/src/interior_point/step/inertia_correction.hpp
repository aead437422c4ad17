// The search direction: Newton's step after a correction of the system's inertia.
#pragma once

#include "interior_point/problem/options.hpp"
#include "newton.hpp"

namespace robotraj::interior_point {

/// Adds delta_w to the Hessian's diagonal and -delta_c to that of the rows until the inertia is right: a positive
/// eigenvalue for each variable and a negative one for each row. The step is then a descent direction:
///
///     delta_w = 0, else kappa_w^- times the last one, then times kappa_w^+ while the reduced Hessian is not positive;
///     delta_c = delta_c_bar mu^(1/4) where rows depend on each other.
///
/// Where rows still depend on each other with delta_c, delta_w grows; beyond its largest value there is no step.
///
/// Before delta_w is added, the Hessian loses the negative curvature of saturations, such as F tanh(v / v_s) of dry
/// friction. It is large within v_s of a reversal, and a delta_w of its size would shorten the steps of all variables.
/// Near an optimum the exact Hessian has the right inertia, so that convergence stays quadratic. After one or more
/// failures of the exact Hessian in a row, one or two steps begin without negative curvature: each failure costs a
/// factorisation.
/// Source: the paper, algorithm IC.
///
/// Where all conditions of optimality hold within the tolerance and only rows are violated, delta_x = 30 eps_tol is added
/// as well. Without it, steps along which the objective is flat are long, as those of joints that do not decide the
/// least time. Each of them violates the rows again. With it, the step changes the variables little beyond what the rows
/// need, and the gradient by no more than delta_x times the step. The first step is always Newton's: it solves a
/// linear-quadratic program, and no flat direction follows from a gradient that vanishes at the start.
///
/// `only_restore` adds 1e4 in its place, since the gradient has not vanished where an objective has merely settled.
class InertiaCorrection {
 public:
  InertiaCorrection(Problem& problem, const Options& options);

  Newton newton;

  void reset() {
    last_ = 0.0;
    failures_ = waits_ = 0;
    first_ = true;
    only_restores_ = false;
  }
  /// Later steps restore the rows and change the variables little beyond that.
  void only_restore() { only_restores_ = true; }
  /// The step of the barrier problem of `mu` in `step`; false where there is none.
  bool find(Iterate& iterate, double mu, const Vectors& step);
  /// The same with other residuals of the rows, by the factors of the last `find`: second-order corrections.
  bool correct(Iterate& iterate, const double* rows, const Vectors& step);
  /// The same with another barrier parameter. `second_order` subtracts the products dz ds of the changes in `step` from
  /// the complementarity: Newton's step neglects them.
  bool aim(Iterate& iterate, double mu, bool second_order, const Vectors& step);
  /// Corrects a step of `find` or `aim` so that a longer one stays centred: products of distances and multipliers after
  /// the lengths `primal` and `dual` outside of [0.1 mu, `largest` mu] are moved to it, downwards by at most `largest` mu.
  bool center(Iterate& iterate, double primal, double dual, double largest, const Vectors& step);

  double seconds = 0.0;  ///< spent on linear algebra

 private:
  Side side(Iterate& iterate, double mu, const double* rows);
  double larger(double delta_w) const;
  double proximal(Iterate& iterate) const;  // delta_x

  Problem& problem_;
  const Options& options_;
  const VectorKernels& run_;
  Packs memory_;
  double *s_, *lower_, *upper_, *damping_;  // parts of the side that are the barrier's
  double *lower_products_, *upper_products_;
  bool second_order_ = false;
  double last_ = 0.0, mu_ = 0.0;
  bool first_ = true, only_restores_ = false;
  int failures_ = 0;  // of the exact Hessian in a row
  int waits_ = 0;     // steps that begin without negative curvature
};

}  // namespace robotraj::interior_point
