// The restoration phase.
#pragma once

#include "algorithm.hpp"
#include "interior_point/problem/feasibility.hpp"

namespace robotraj::interior_point {

/// Lowers the violation by the same iteration on `Feasibility`, until it is halved and the line search that gave up
/// accepts the point. Source: the paper, section 3.3.
class Restoration {
 public:
  Restoration(ProgramProblem& original, const Options& options, Progress& progress);

  /// Leaves a point in `original.trial`, or returns why there is none.
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
