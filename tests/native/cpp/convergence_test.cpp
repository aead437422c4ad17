// The error of the optimality conditions against its definition, and the two kinds of convergence.
#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {

using interior_point::Converged;

ROBOTRAJ_TEST(the_error_is_the_scaled_one_of_the_paper) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  for (const double size : {1.0, 1e4}) {  // multipliers whose mean is below and above s_max
    for (int i = 0; i < 6; ++i) at.at->rows[i] = size * (i - 2.5);
    for (int i = 0; i < 5; ++i) {
      at.at->lower[i] = size * (i + 1);
      at.at->upper[i] = i == 0 ? 0.0 : size * (6 - i);
    }
    at.turned();
    const double mu = 0.3;
    double rows = 0.0, bounds = 0.0, complementarity = 0.0;
    for (int i = 0; i < 6; ++i) rows += std::abs(at.at->rows[i]);
    for (int i = 0; i < 5; ++i) {
      bounds += at.at->lower[i] + at.at->upper[i];
      complementarity = std::max(complementarity, std::abs(at.at->lower[i] * at.below()[i] - mu));
      if (i > 0) complementarity = std::max(complementarity, std::abs(at.at->upper[i] * at.above()[i] - mu));
    }
    const double s_d = std::max(100.0, (rows + bounds) / (6 + 9)) / 100.0, s_c = std::max(100.0, bounds / 9) / 100.0;
    const double expected = std::max({at.largest_infeasibility() / s_d, at.largest_violation(), complementarity / s_c});
    CHECK(std::abs(interior_point::error(at, mu) - expected) < 1e-12 * expected);
    double products = 0.0;
    for (int i = 0; i < 5; ++i) products += at.at->lower[i] * at.below()[i] + at.at->upper[i] * at.above()[i];
    CHECK(std::abs(interior_point::mean_complementarity(at) - products / 9) < 1e-12 * products);
  }
}

ROBOTRAJ_TEST(an_acceptable_error_counts_only_in_a_row) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  const double now = interior_point::error(at, 0.0);
  interior_point::Options options;
  options.violation_tolerance = 1e3;
  options.tolerance = 0.5 * now;
  options.acceptable_tolerance = 2.0 * now;
  options.acceptable_iterations = 3;
  interior_point::Convergence convergence(options);
  CHECK(convergence.check(at) == Converged::no);
  CHECK(convergence.check(at) == Converged::no);
  CHECK(convergence.check(at) == Converged::acceptable);
  options.acceptable_tolerance = 0.9 * now;
  CHECK(convergence.check(at) == Converged::no);
  options.acceptable_tolerance = 2.0 * now;
  CHECK(convergence.check(at) == Converged::no);
  options.tolerance = now;
  CHECK(convergence.check(at) == Converged::solved);
  options.violation_tolerance = 0.5 * at.largest_violation();
  CHECK(convergence.check(at) == Converged::no);
}

ROBOTRAJ_TEST(the_adaptive_rule_ends_with_small_products) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  double largest = 0.0;
  for (int i = 0; i < 5; ++i) {
    largest = std::max(largest, at.at->lower[i] * at.below()[i]);
    if (i > 0) largest = std::max(largest, at.at->upper[i] * at.above()[i]);
  }
  interior_point::Options options;
  options.violation_tolerance = 1e3;
  interior_point::Convergence convergence(options);
  for (const double share : {9.0, 11.0}) {
    options.tolerance = share * largest;
    CHECK(interior_point::error(at, 0.0) < options.tolerance);
    options.adaptive_barrier = false;
    CHECK(convergence.check(at) == Converged::solved);
    options.adaptive_barrier = true;
    CHECK((convergence.check(at) == Converged::solved) == (share > 10.0));
  }
}

ROBOTRAJ_TEST(an_objective_has_settled_after_eight_iterations_with_nearly_the_same_objective) {
  Started its({3.0, 3.0, 3.0, std::sqrt(13.0)});  // on every row
  interior_point::Iterate& at = *its.run.current;
  interior_point::Options options;
  interior_point::Convergence convergence(options);
  for (int count = 0; count < 20; ++count) CHECK(!convergence.settled(at));
  options.objective_change = 1e-3;
  for (const double change : {2e-3, 1e-4}) {
    convergence.reset();
    its.problem.objective_scale = 1.0 + change;
    at.moved();
    CHECK(!convergence.settled(at));
    its.problem.objective_scale = 1.0;
    at.moved();
    for (int count = 1; count < 8; ++count) CHECK(!convergence.settled(at));
    CHECK(convergence.settled(at) == (change < 1e-3));
  }
  // The first objective is forgotten.
  convergence.reset();
  its.problem.objective_scale = 2.0;
  at.moved();
  convergence.settled(at);
  its.problem.objective_scale = 1.0;
  at.moved();
  for (int count = 1; count < 9; ++count) CHECK(!convergence.settled(at));
  CHECK(convergence.settled(at));
  // A point far from the rows has no objective yet.
  at.at->x[0] = 2.0;
  at.moved();
  CHECK(at.largest_violation() > 1e-2);
  CHECK(!convergence.settled(at));
}

ROBOTRAJ_TEST(an_objective_is_near_another_one_within_a_hundredth) {
  Started its({3.0, 3.0, 3.0, std::sqrt(13.0)});
  interior_point::Iterate& at = *its.run.current;
  const interior_point::Options options;
  const interior_point::Convergence convergence(options);
  const double objective = at.objective();
  CHECK(convergence.is_near(at, objective));
  CHECK(convergence.is_near(at, objective * (1.0 + 9e-3)));
  CHECK(!convergence.is_near(at, objective * (1.0 + 2e-2)));
  CHECK(!convergence.is_near(at, objective * (1.0 - 2e-2)));
}

ROBOTRAJ_TEST(products_above_the_change_of_the_objective_are_a_gap) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  const double sum = 9 * interior_point::mean_complementarity(at);
  interior_point::Options options;
  interior_point::Convergence convergence(options);
  for (const double factor : {0.9, 1.1}) {
    options.objective_change = factor * sum / std::abs(at.objective());
    CHECK(convergence.has_gap(at) == (factor < 1.0));
  }
}

}  // namespace robotraj::tests
