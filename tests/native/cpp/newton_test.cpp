// Newton's step against a dense solve.
#include <Eigen/Dense>

#include <cmath>
#include <random>

#include "check.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(directions_solve_the_primal_dual_system) {
  Started its;
  native::Program& program = its.problem.program();
  interior_point::Iterate& at = *its.run.current;
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
    program.set_point(at.at->x);
    const native::Numbers jacobian = program.jacobian(), hessian = program.hessian(at.at->rows, 1.0);
    for (std::size_t e = 0; e < hessian.size(); ++e) {
      const int i = program.hessian_pattern().rows[e], j = program.hessian_pattern().columns[e];
      matrix(i, j) = matrix(j, i) = hessian[e];
    }
    for (int i = 0; i < n; ++i) matrix(i, i) += delta_w;
    for (std::size_t e = 0; e < jacobian.size(); ++e) {
      const int i = n + program.jacobian_pattern().rows[e], j = program.jacobian_pattern().columns[e];
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
    interior_point::Newton& newton = its.run.direction.newton;
    its.problem.hessian(at.at->x, at.at->rows, false, newton.hessian());
    interior_point::Room step(its.problem);
    const double* given = side.data();
    CHECK(newton.solve(at, {given, given + n, given + n + m, given + n + m + s, given + n + m + 2 * s}, delta_w,
                       delta_c, step.get()) == interior_point::Solved::good);
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

}  // namespace robotraj::tests
