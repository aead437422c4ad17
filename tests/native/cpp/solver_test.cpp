// Solves from a cold and a warm start against a published optimum, and of a problem without a solution.
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(the_published_optimum_is_found_cold_and_warm) {
  interior_point::Solver solver(hock_schittkowski_71(), its_stages());
  interior_point::Options options;
  interior_point::Start start;
  start.y = its_start.data();
  start.lower = its_lower.data();
  start.upper = its_upper.data();
  const auto cold = solver.solve(start, options, [](int, double, double) {});
  CHECK(cold.status == "solved");
  CHECK(std::abs(cold.objective - 17.0140173) < 1e-6);
  CHECK(cold.violation < 1e-6);
  start.y = cold.y.data();
  start.lam = cold.lam.data();
  start.lower_duals = cold.lower_duals.data();
  start.upper_duals = cold.upper_duals.data();
  options.initial_barrier = 1e-9;
  const auto warm = solver.solve(start, options, [](int, double, double) {});
  CHECK(warm.status == "solved");
  CHECK(warm.iterations <= 2);
  CHECK(cold.iterations > 4);
}

ROBOTRAJ_TEST(a_problem_without_a_point_is_called_infeasible) {
  interior_point::Solver solver(hock_schittkowski_71(), its_stages());
  std::vector<double> lower = its_lower;
  lower[0] = 700.0;  // the product is at most 625
  interior_point::Start start;
  start.y = its_start.data();
  start.lower = lower.data();
  start.upper = its_upper.data();
  CHECK(solver.solve(start, {}, [](int, double, double) {}).status == "infeasible");
}

}  // namespace robotraj::tests
