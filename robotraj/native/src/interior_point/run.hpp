// State that the parts of one iteration share.
#pragma once

#include <algorithm>
#include <memory>

#include "interior_point/problem/options.hpp"
#include "interior_point/step/inertia_correction.hpp"

namespace robotraj::interior_point {

/// The current point, the trial point, the step between them and the barrier parameter.
struct Run {
  Run(Problem& solved, const Options& given)
      : problem(solved),
        options(given),
        current(std::make_unique<Iterate>(solved)),
        trial(std::make_unique<Iterate>(solved)),
        step(solved),
        direction(solved, given) {}

  /// Fraction of the way to a bound that a step may go: tau = max(tau_min, 1 - mu), the paper's equation 8. With
  /// `leaves_more` it goes less far: a slack next to its bound would shorten the steps after it.
  double tau() const { return leaves_more ? std::max(0.9, 1.0 - 1e3 * mu) : std::max(0.99, 1.0 - mu); }
  void set_barrier(double value) {
    mu = value;
    problem.set_barrier(mu);
    current->barrier_changed();
  }

  Problem& problem;
  const Options& options;
  std::unique_ptr<Iterate> current, trial;
  Room step;
  InertiaCorrection direction;
  double mu = 0.0;
  bool leaves_more = false;  ///< of the way to a bound; set by `Barrier`
};

}  // namespace robotraj::interior_point
