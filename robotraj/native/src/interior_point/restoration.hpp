// The restoration phase.
#pragma once

#include "algorithm.hpp"
#include "interior_point/problem/feasibility.hpp"

namespace robotraj::interior_point {

/// Lowers the violation theta by the same iteration on `Feasibility`, from mu = max(mu, max |c|), to a point with
///
///     theta <= kappa_resto theta_0,   kappa_resto = 0.02,
///
/// that the filter of the line search accepts. Multipliers of the bounds then follow the slacks by one Newton step, and
/// those of the rows start at zero. A solution of `Feasibility` that still violates rows shows that the problem is
/// locally infeasible. Source: the paper, section 3.3.
class Restoration {
 public:
  Restoration(ProgramProblem& original, const Options& options, Progress& progress);

  /// Writes a point to `original.trial`, or returns why there is none.
  End restore(Run& original, const LineSearch& search);

  double seconds() const { return algorithm_.run.direction.seconds; }
  void clear_seconds() { algorithm_.run.direction.seconds = 0.0; }

 private:
  void start(Run& original);
  void take_point(Run& original);
  void step_duals(Run& original) const;

  const Options& options_;
  Feasibility problem_;
  Algorithm algorithm_;
};

}  // namespace robotraj::interior_point
