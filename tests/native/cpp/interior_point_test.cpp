// The filter against its definition, directions against a dense solve, a solve against a published optimum.
#include <Eigen/Dense>

#include <cmath>
#include <random>

#include "check.hpp"
#include "interior_point/filter.hpp"
#include "interior_point/start.hpp"
#include "interior_point/step/newton.hpp"

namespace robotraj::tests {
namespace {

using interior_point::Filter;
using interior_point::Newton;
using interior_point::ProgramProblem;
using interior_point::Run;
using interior_point::Solved;
using native::Layout;

}  // namespace

ROBOTRAJ_TEST(the_filter_refuses_what_a_corner_is_at_least_as_good_as) {
  std::mt19937 random(0);
  std::uniform_int_distribution<int> level(0, 9);
  for (int round = 0; round < 200; ++round) {
    Filter filter;
    std::vector<std::pair<int, int>> corners;
    for (int k = 0; k < 8; ++k) {
      corners.emplace_back(level(random), level(random));
      filter.add(corners.back().first, corners.back().second);
    }
    CHECK(filter.size() <= corners.size());
    for (int violation = 0; violation < 10; ++violation)
      for (int barrier = 0; barrier < 10; ++barrier) {
        bool accepted = true;
        for (const auto& [v, b] : corners) accepted = accepted && !(violation >= v && barrier >= b);
        CHECK(filter.accepts(violation, barrier) == accepted);
      }
  }
}

ROBOTRAJ_TEST(directions_solve_the_primal_dual_system) {
  const auto program = hock_schittkowski_71();
  const Layout layout(its_stages());
  ProgramProblem problem(program, layout);
  problem.lower = its_lower;
  problem.upper = its_upper;
  problem.bounds_changed();
  const interior_point::Options options;
  Run run(problem, options);
  run.mu = 0.1;
  interior_point::start_cold(run, its_start.data());
  interior_point::Iterate& at = *run.current;
  const int n = 4, m = 6, s = 5, unknowns = n + m + 3 * s;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double delta_c : {0.0, 1e-3}) {
    const double delta_w = 20.0;
    Eigen::VectorXd side(unknowns);
    for (int i = 0; i < unknowns; ++i) side[i] = normal(random);
    side[n + m + 2 * s] = 0.0;  // the product has no upper bound
    for (int i = 0; i < m; ++i) at.at->rows[i] = normal(random);
    at.turned();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
    program->set_point(at.at->x);
    const native::Numbers jacobian = program->jacobian(), hessian = program->hessian(at.at->rows, 1.0);
    for (std::size_t e = 0; e < hessian.size(); ++e) {
      const int i = program->hessian_pattern().rows[e], j = program->hessian_pattern().columns[e];
      matrix(i, j) = matrix(j, i) = hessian[e];
    }
    for (int i = 0; i < n; ++i) matrix(i, i) += delta_w;
    for (std::size_t e = 0; e < jacobian.size(); ++e) {
      const int i = n + program->jacobian_pattern().rows[e], j = program->jacobian_pattern().columns[e];
      matrix(i, j) = matrix(j, i) = jacobian[e];
    }
    for (int i = 0; i < m; ++i) matrix(n + i, n + i) = -delta_c;
    for (int i = 0; i < s; ++i) {
      const int row = n + 1 + i, slack = n + m + i, lower = slack + s, upper = lower + s;
      matrix(row, slack) = matrix(slack, row) = -1.0;
      matrix(slack, slack) = delta_w;
      matrix(slack, lower) = -1.0;
      matrix(slack, upper) = 1.0;
      matrix(lower, slack) = at.at->lower[i];
      matrix(lower, lower) = at.below()[i];
      matrix(upper, slack) = -at.at->upper[i];
      matrix(upper, upper) = at.above()[i];
    }
    const Eigen::VectorXd expected = matrix.fullPivLu().solve(-side);
    Newton& newton = run.direction.newton;
    problem.hessian(at.at->x, at.at->rows, newton.hessian());
    interior_point::Room step(problem);
    const double* given = side.data();
    CHECK(newton.solve(at, {given, given + n, given + n + m, given + n + m + s, given + n + m + 2 * s}, delta_w,
                       delta_c, step.get()) == Solved::good);
    const auto near = [&](const double* found, int first, int count) {
      for (int i = 0; i < count; ++i) CHECK(std::abs(found[i] - expected[first + i]) < 1e-6);
    };
    near(step->x, 0, n);
    near(step->rows, n, m);
    near(step->s, n + m, s);
    near(step->lower, n + m + s, s);
    near(step->upper, n + m + 2 * s, s);
  }
}

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
