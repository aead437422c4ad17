// Points of the restoration phase against its conditions.
#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {

using interior_point::End;

ROBOTRAJ_TEST(a_restored_point_has_a_fiftieth_of_the_violation_and_is_accepted) {
  for (const std::vector<double>& x : {std::vector<double>{1.1, 1.1, 1.1, 1.1}, {4.9, 4.9, 4.9, 4.9}}) {
    Started its(x);
    const double before = its.run.current->violation();
    its.algorithm.search.start();
    its.algorithm.search.give_up();
    interior_point::Restoration restoration(its.problem, its.options, its.progress);
    CHECK(restoration.restore(its.run, its.algorithm.search) == End::restored);
    interior_point::Iterate& to = *its.run.trial;
    CHECK(to.violation() <= 0.02 * before);
    CHECK(its.algorithm.search.accepts(to.violation(), to.barrier(its.run.mu)));
    for (int i = 0; i < 5; ++i) {
      CHECK(to.below()[i] > 0.0 && to.above()[i] > 0.0);
      CHECK(to.at->lower[i] >= 0.0 && to.at->upper[i] >= 0.0);
      CHECK(to.at->rows[i] == 0.0);
    }
    CHECK(its.progress.iterations > 0);
    CHECK(its.progress.trace.size() == static_cast<std::size_t>(its.progress.iterations) + 1);
  }
}

ROBOTRAJ_TEST(the_least_violation_that_is_not_zero_is_infeasible) {
  Started its;
  its.problem.lower[0] = 700.0;  // |x|^2 = 40 allows a product of 100
  its.problem.bounds_changed();
  interior_point::start_cold(its.run, its_start.data());
  its.algorithm.search.start();
  its.algorithm.search.give_up();
  interior_point::Restoration restoration(its.problem, its.options, its.progress);
  // Points of less violation are restored as well; from the last of them on there is none.
  End end = End::restored;
  for (int round = 0; end == End::restored && round < 20; ++round) {
    end = restoration.restore(its.run, its.algorithm.search);
    if (end != End::restored) break;
    std::swap(its.run.current, its.run.trial);
    its.algorithm.search.give_up();
  }
  CHECK(end == End::infeasible);
  CHECK(its.run.trial->largest_violation() > 1.0);
}

ROBOTRAJ_TEST(a_step_that_fails_where_the_rows_hold_ends_the_solve_without_the_restoration_phase) {
  // A hundredth of the tolerance is 1e-10; |x|^2 - 40 is 5e-11 and 1.5e-10.
  for (const double beyond : {7e-12, 2.1e-11}) {
    for (const double acceptable : {1e-6, 1e9}) {
      // The concave objective needs a correction of the Hessian, and the first one is too large.
      Started its({3.0, 3.0, 3.0, std::sqrt(13.0) + beyond}, 0.1, -100.0);
      its.options.first_correction = 1e41;
      its.options.acceptable_tolerance = acceptable;
      std::fill_n(its.run.current->at->rows, 6, 0.0);
      its.run.current->turned();
      interior_point::Restoration restoration(its.problem, its.options, its.progress);
      bool begun = false;
      its.algorithm.restoration = [&]() -> interior_point::Restoration& {
        begun = true;
        return restoration;
      };
      its.algorithm.line = [] { return interior_point::Iteration{}; };
      const End end = its.algorithm.iterate(0.1);
      const bool feasible = its.run.current->largest_violation() < 1e-10;
      CHECK(feasible == (beyond < 1e-11));
      CHECK(begun != feasible);
      if (feasible) CHECK(end == (acceptable > 1.0 ? End::acceptable : End::step_failed));
    }
  }
}

}  // namespace robotraj::tests
