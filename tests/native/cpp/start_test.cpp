// Where a solve starts: slacks inside their bounds, multipliers of least squares, products of at least mu.
#include <Eigen/Dense>

#include <cmath>
#include <limits>

#include "check.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(a_cold_start_moves_slacks_inside_and_estimates_multipliers) {
  Started its({0.0, 5.0, 3.0, 7.0});
  interior_point::Iterate& at = *its.run.current;
  const double expected[] = {25.25, 1.01, 4.96, 3.0, 4.96};  // min(0.01 max(1, |bound|), 0.01 range) from the bounds
  for (int i = 0; i < 5; ++i) {
    CHECK(std::abs(at.at->s[i] - expected[i]) < 1e-12);
    CHECK(at.at->lower[i] == 1.0);
    CHECK(at.at->upper[i] == (i == 0 ? 0.0 : 1.0));
  }
  // min |g_x + A' lam|^2 + |g_s + (dc / ds)' lam|^2 over lam, with dc / ds = -1 in the last five rows.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(9, 6);
  Eigen::VectorXd side(9);
  const native::Pattern& pattern = its.problem.program().jacobian_pattern();
  its.problem.program().set_point(at.at->x);
  const native::Numbers jacobian = its.problem.program().jacobian();
  for (std::size_t e = 0; e < jacobian.size(); ++e) matrix(pattern.columns[e], pattern.rows[e]) = jacobian[e];
  for (int i = 0; i < 4; ++i) side[i] = at.gradient_x()[i];
  for (int i = 0; i < 5; ++i) {
    matrix(4 + i, 1 + i) = -1.0;
    side[4 + i] = -at.at->lower[i] + at.at->upper[i];
  }
  const Eigen::VectorXd lam = matrix.colPivHouseholderQr().solve(-side);
  for (int i = 0; i < 6; ++i) CHECK(std::abs(at.at->rows[i] - lam[i]) < 1e-7 * lam.norm());
  interior_point::estimate_multipliers(its.run, 0.5 * lam.lpNorm<Eigen::Infinity>());
  for (int i = 0; i < 6; ++i) CHECK(at.at->rows[i] == 0.0);
}

ROBOTRAJ_TEST(a_warm_start_keeps_products_of_at_least_mu) {
  Started its;
  const double mu = its.run.mu = 0.01;
  const double rows[] = {1.0, -2.0, 3.0, 0.0, 0.5, -0.5};
  const double lower[] = {1e-9, 5.0, 0.0, 0.0, 0.2}, upper[] = {3.0, 0.0, 2.0, 0.0, 0.0};
  const double x[] = {0.5, 5.0, 3.0, 1.0};  // outside, at a bound, inside, at a bound
  interior_point::start_warm(its.run, x, {rows, lower, upper});
  interior_point::Iterate& at = *its.run.current;
  for (int i = 0; i < 6; ++i) CHECK(at.at->rows[i] == rows[i]);
  for (int i = 0; i < 5; ++i) {
    CHECK(at.at->s[i] > its_lower[static_cast<std::size_t>(i)]);
    CHECK(at.at->s[i] < its_upper[static_cast<std::size_t>(i)]);
    CHECK(at.at->lower[i] * at.below()[i] >= mu * (1.0 - 1e-12));
    if (i > 0) CHECK(at.at->upper[i] * at.above()[i] >= mu * (1.0 - 1e-12));
  }
  CHECK(at.at->upper[0] == 0.0);
  CHECK(std::abs(at.at->s[1] - (1.0 + mu / 5.0)) < 1e-12);  // its multiplier is known
  CHECK(std::abs(at.at->s[3] - 3.0) < 1e-12);
}

}  // namespace robotraj::tests
