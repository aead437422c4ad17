// The monotone and the adaptive rule of the barrier parameter against their formulas.
#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(the_monotone_rule_lowers_mu_while_its_problem_is_solved) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  interior_point::Barrier& barrier = its.algorithm.barrier;
  for (const double mu : {1e-3, 0.1, 1e3}) {
    barrier.start(mu);
    double expected = mu;
    const double least = 1e-8 / 11.0;
    while (interior_point::error(at, expected) <= 10.0 * expected) {
      const double next = std::max(least, std::min(0.2 * expected, std::pow(expected, 1.5)));
      if (!(next < expected)) break;
      expected = next;
    }
    CHECK(barrier.update() == (expected < mu));
    CHECK(its.run.mu == expected);
    CHECK(!barrier.is_free());
  }
}

ROBOTRAJ_TEST(a_parameter_falls_without_a_solution_only_where_it_falls_monotonically) {
  Started its;
  interior_point::Barrier& barrier = its.algorithm.barrier;
  barrier.start(1e-3);
  CHECK(interior_point::error(*its.run.current, 1e-3) > 1e-2);
  CHECK(barrier.fall());
  CHECK(its.run.mu == std::pow(1e-3, 1.5));
  barrier.start(1e-8 / 11.0);
  CHECK(!barrier.fall());
  its.options.adaptive_barrier = true;
  barrier.start(1e-3);
  CHECK(!barrier.fall());
}

ROBOTRAJ_TEST(steps_of_a_small_first_parameter_that_falls_monotonically_leave_more_of_the_way_to_a_bound) {
  Started its;
  interior_point::Barrier& barrier = its.algorithm.barrier;
  barrier.start(1e-3);
  CHECK(its.run.tau() == 1.0 - 1e-3);
  its.options.initial_barrier = 1e-4;
  barrier.start(1e-4);
  CHECK(its.run.tau() == 0.9);
  barrier.start(1e-6);
  CHECK(std::abs(its.run.tau() - 0.999) < 1e-15);
  its.options.adaptive_barrier = true;
  barrier.start(1e-4);
  CHECK(its.run.tau() == 1.0 - 1e-4);
}

ROBOTRAJ_TEST(the_adaptive_rule_is_the_cube_of_what_the_predictor_leaves) {
  Started its;
  its.options.adaptive_barrier = true;
  interior_point::Iterate& at = *its.run.current;
  its.algorithm.barrier.start(0.1);
  CHECK(its.algorithm.barrier.is_free());
  const double mean = interior_point::mean_complementarity(at);
  interior_point::Room step(its.problem);
  CHECK(its.run.direction.find(at, 0.0, step.get()));
  // The longest steps to a bound and to a multiplier of zero.
  double primal = 1.0, dual = 1.0, sum = 0.0;
  for (int i = 0; i < 5; ++i) {
    if (step->s[i] < 0.0) primal = std::min(primal, at.below()[i] / -step->s[i]);
    if (i > 0 && step->s[i] > 0.0) primal = std::min(primal, at.above()[i] / step->s[i]);
    if (step->lower[i] < 0.0) dual = std::min(dual, at.at->lower[i] / -step->lower[i]);
    if (i > 0 && step->upper[i] < 0.0) dual = std::min(dual, at.at->upper[i] / -step->upper[i]);
  }
  for (int i = 0; i < 5; ++i) {
    sum += (at.at->lower[i] + dual * step->lower[i]) * (at.below()[i] + primal * step->s[i]);
    if (i > 0) sum += (at.at->upper[i] + dual * step->upper[i]) * (at.above()[i] - primal * step->s[i]);
  }
  const double expected = std::min(1.0, std::pow(sum / 9 / mean, 3)) * mean;
  CHECK(its.algorithm.barrier.choose());
  CHECK(std::abs(its.run.mu - expected) < 1e-10 * expected);
  // Five errors that do not fall make the rule monotone, from 0.8 of the mean on.
  for (int k = 0; k < 4; ++k) its.algorithm.barrier.update();
  CHECK(its.algorithm.barrier.is_free());
  CHECK(its.algorithm.barrier.update());
  CHECK(!its.algorithm.barrier.is_free());
  CHECK(std::abs(its.run.mu - 0.8 * mean) < 1e-12 * mean);
}

}  // namespace robotraj::tests
