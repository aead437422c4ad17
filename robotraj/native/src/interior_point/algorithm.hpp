// The iteration.
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

/// What is counted and asked once an iteration, in the restoration phase too.
struct Progress {
  int iterations = 0;
  std::vector<Iteration> trace;
  std::function<void(int, double, double)> check;
};

enum class End {
  solved,
  acceptable,
  restored,
  iteration_limit,
  processor_limit,
  infeasible,
  line_search_failed,
  step_failed,
  invalid_number
};

class Restoration;

/// Steps along `Direction`, as long as `LineSearch` accepts, for a parameter that `Barrier` lowers, until `Convergence`
/// holds. Source: the paper, algorithm A.
class Algorithm {
 public:
  Algorithm(Problem& problem, const Options& options, Progress& progress);
  ~Algorithm();

  Run run;
  LineSearch search;
  Barrier barrier;

  /// Sets the phase that follows a line search that fails; without it a step that is too short ends the solve.
  std::function<Restoration&()> restoration;
  /// Ends the iteration as `restored`; asked from the second iteration on.
  std::function<bool()> goal;
  /// Writes the line of the log.
  std::function<Iteration()> line;

  /// From `run.current` on, which is started.
  End iterate(double mu);

 private:
  bool step();
  End restore(bool stepped);
  void accept();
  bool out_of_time() const;

  const Options& options_;
  Progress& progress_;
  Convergence convergence_;
  double began_ = 0.0;
};

}  // namespace robotraj::interior_point
