// A point of the iteration, and the functions that were evaluated at it.
#pragma once

#include "problem.hpp"

namespace robotraj::interior_point {

using native::VectorKernels;

/// One number for every unknown: primal variables, rows' multipliers, slacks, multipliers of the slacks' bounds. They
/// follow each other in memory, with zeros in between.
struct Vectors {
  double *x, *rows, *s, *lower, *upper;
};

/// Memory of `Vectors`.
class Room {
 public:
  explicit Room(const Problem& problem);
  /// Numbers in all of them, zeros in between included.
  static int size(const Problem& problem);

  const Vectors& get() const { return vectors_; }
  Vectors* operator->() { return &vectors_; }
  const Vectors* operator->() const { return &vectors_; }
  void copy(const Room& other) { memory_ = other.memory_; }

 private:
  Packs memory_;
  Vectors vectors_;
};

/// Evaluates each function on demand, once a point. Code that writes variables calls `moved` or `turned`.
class Iterate {
 public:
  explicit Iterate(Problem& problem);

  Problem& problem() { return problem_; }
  Room at;  ///< x, lam, s, z_l and z_u

  void moved() { known_ = {}; }                    ///< x or s were written
  void turned() { known_.infeasibility = false; }  ///< multipliers were written
  void barrier_changed() { known_.objective = known_.gradient = known_.infeasibility = false; }
  void copy(const Iterate& other);

  double objective();
  const double* residual();
  double violation();  ///< theta, the sum of the rows' magnitudes
  double largest_violation();
  const double* below();  ///< s - lower, 1 where there is no bound
  const double* above();
  /// phi_mu = f - mu sum(log(distances)) + kappa_d mu sum(distances of slacks with one bound).
  double barrier(double mu);
  /// Of the objective.
  const double* gradient_x();
  const double* gradient_s();
  const StageValues& jacobian();
  /// Gradient of the Lagrangian f + lam' c - z_l' (s - lower) - z_u' (upper - s), the dual infeasibility.
  const double* infeasibility_x();
  const double* infeasibility_s();
  double largest_infeasibility();

  static constexpr double kappa_d = 1e-5;

 private:
  struct Known {
    bool objective = false, residual = false, distances = false, gradient = false, jacobian = false,
         infeasibility = false;
  };
  void measure_distances();
  void differentiate();
  void differentiate_lagrangian();

  Problem& problem_;
  const VectorKernels& run_;
  Known known_;
  Packs memory_;
  double *residual_, *below_, *above_, *gradient_x_, *gradient_s_, *infeasibility_x_, *infeasibility_s_;
  StageValues jacobian_;
  double objective_ = 0.0, violation_ = 0.0, largest_violation_ = 0.0, logarithms_ = 0.0, single_ = 0.0,
         largest_infeasibility_ = 0.0;
};

}  // namespace robotraj::interior_point
