// The iteration: a step, the search along it, the accepted point.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "barrier.hpp"
#include "interior_point/problem/convergence.hpp"
#include "line_search.hpp"
#include "run.hpp"

namespace robotraj::interior_point {

/// One line of the log: objective, largest violated equality, largest dual infeasibility, barrier parameter.
using Iteration = std::array<double, 4>;

/// The count, the log and the caller's check of every iteration; those of the restoration phase are among them.
struct Progress {
  int iterations = 0;
  std::vector<Iteration> trace;
  std::function<void(int, double, double)> check;
};

enum class End {
  solved,
  acceptable,
  settled,
  restored,
  iteration_limit,
  processor_limit,
  infeasible,
  line_search_failed,
  step_failed,
  invalid_number
};

class Restoration;

/// Solves barrier problems of falling parameters mu,
///
///     minimise f(x, s) - mu sum log(s - lower) - mu sum log(upper - s)   subject to   c(x, s) = 0,
///
/// each by damped Newton steps. `InertiaCorrection` computes a step, `LineSearch` its length, `Barrier` lowers mu, and
/// `Convergence` ends the iteration. Once the objective has settled, steps only restore the rows, and the iteration ends
/// where these hold within the tolerance, unless a restoration phase has changed the objective. With d the distance of an
/// accepted slack from a bound, the bound's multiplier z is kept near mu / d, so that the Hessian of the system stays
/// close to the one of the barrier problem:
///
///     z <- max(min(z, kappa_Sigma mu / d), mu / (kappa_Sigma d)).
///
/// Source: the paper, algorithm A and equation 16.
class Algorithm {
 public:
  Algorithm(Problem& problem, const Options& options, Progress& progress);
  ~Algorithm();

  Run run;
  LineSearch search;
  Barrier barrier;

  /// Returns the phase that follows a line search that fails; without it such a line search ends the solve.
  std::function<Restoration&()> restoration;
  /// Whether the iteration ends as `restored`; called from the second iteration on.
  std::function<bool()> goal;
  /// Returns the line of the log.
  std::function<Iteration()> line;

  /// Iterates from `run.current`, whose variables and multipliers are set, with the first parameter mu.
  End iterate(double mu);

 private:
  bool settled();
  bool step();
  End restore(bool stepped);
  void accept();
  bool out_of_time() const;

  const Options& options_;
  Progress& progress_;
  Convergence convergence_;
  double began_ = 0.0;
  bool settled_ = false;  // steps only restore the rows
  double settled_objective_ = 0.0;
};

}  // namespace robotraj::interior_point
