// Search directions where the Hessian is indefinite, and those of the same factors.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {
namespace {

/// Largest residual of the linearised rows, A dx + (dc / ds) ds + c.
double left_of_rows(Started& its, const interior_point::Room& step, const double* c) {
  native::Program& program = its.problem.program();
  program.set_point(its.run.current->at->x);
  const native::Numbers jacobian = program.jacobian();
  Eigen::VectorXd left(6);
  for (int i = 0; i < 6; ++i) left[i] = c[i] - (i > 0 ? step->s[i - 1] : 0.0);
  for (std::size_t e = 0; e < jacobian.size(); ++e)
    left[program.jacobian_pattern().rows[e]] += jacobian[e] * step->x[program.jacobian_pattern().columns[e]];
  return left.lpNorm<Eigen::Infinity>();
}

}  // namespace

ROBOTRAJ_TEST(directions_descend_where_the_objective_is_concave) {
  // Every row holds at this point, so a direction descends exactly where the reduced Hessian is positive along it.
  Started its({3.0, 3.0, 3.0, std::sqrt(13.0)}, 0.1, -100.0);
  interior_point::Iterate& at = *its.run.current;
  CHECK(at.violation() < 1e-12);
  for (int i = 0; i < 6; ++i) at.at->rows[i] = 0.0;
  at.turned();
  interior_point::Room step(its.problem);
  interior_point::Newton& newton = its.run.direction.newton;
  CHECK(its.run.direction.find(at, its.run.mu, step.get()));
  CHECK(left_of_rows(its, step, at.residual()) < 1e-6);
  double slope = 0.0;
  for (int i = 0; i < 4; ++i) slope += at.gradient_x()[i] * step->x[i];
  for (int i = 0; i < 5; ++i) {
    slope += its.run.mu * step->s[i] * (i > 0 ? 1.0 / at.above()[i] : interior_point::Iterate::kappa_d);
    slope -= its.run.mu * step->s[i] / at.below()[i];
  }
  CHECK(slope < 0.0);
  // The Hessian as it is has too many negative eigenvalues.
  const std::vector<double> none(6, 0.0);
  const double* zero = none.data();
  CHECK(newton.solve(at, {zero, zero, zero, zero, zero}, 0.0, 0.0, step.get()) == interior_point::Solved::indefinite);
}

ROBOTRAJ_TEST(negative_curvature_of_saturations_is_dropped_before_the_hessian_is_damped) {
  Started its({3.0, 3.0, 3.0, std::sqrt(13.0)}, 0.1, -100.0, true);
  interior_point::Iterate& at = *its.run.current;
  for (int i = 0; i < 6; ++i) at.at->rows[i] = 0.0;
  at.turned();
  interior_point::Room step(its.problem);
  CHECK(its.run.direction.find(at, its.run.mu, step.get()));
  CHECK(left_of_rows(its, step, at.residual()) < 1e-6);
  // Without its curvature, which is all that the Hessian has here, the direction needs no damping.
  for (const double entry : its.run.direction.newton.hessian()) CHECK(entry == 0.0);
  const std::vector<double> none(6, 0.0);
  const double* zero = none.data();
  const interior_point::Side side{zero, zero, zero, zero, zero};
  CHECK(its.run.direction.newton.solve(at, side, 0.0, 0.0, step.get()) == interior_point::Solved::good);
}

ROBOTRAJ_TEST(steps_are_short_where_only_rows_are_violated) {
  Started its(its_start, 0.1, 1e-4);
  interior_point::Iterate& at = *its.run.current;
  const double dual = interior_point::dual_error(at, 0.0), violation = at.largest_violation();
  CHECK(dual < 0.9 * violation);
  interior_point::Room step(its.problem);
  const auto length = [&](double tolerance) {
    its.options.tolerance = tolerance;
    CHECK(its.run.direction.find(at, its.run.mu, step.get()));
    CHECK(left_of_rows(its, step, at.residual()) < 1e-6);
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += step->x[i] * step->x[i];
    return std::sqrt(sum);
  };
  const double between = 0.5 * (dual + violation), first = length(between), shorter = length(between);
  const double plain = length(0.9 * dual);
  CHECK(std::abs(first - plain) < 1e-6 * plain);
  CHECK(shorter < (1.0 - 1e-4) * plain);
  // Nor is it shortened where the rows hold within the tolerance.
  CHECK(std::abs(length(1.1 * violation) - plain) < 1e-6 * plain);
}

ROBOTRAJ_TEST(steps_that_only_restore_the_rows_are_short_away_from_an_optimum) {
  Started its({3.0, 3.0, 3.0, std::sqrt(13.0)});  // on every row
  interior_point::InertiaCorrection& direction = its.run.direction;
  interior_point::Room newton(its.problem), restoring(its.problem);
  CHECK(direction.find(*its.run.current, 0.1, newton.get()));
  direction.only_restore();
  CHECK(direction.find(*its.run.current, 0.1, restoring.get()));
  const auto length = [&](const interior_point::Room& step) {
    double sum = 0.0;
    for (int i = 0; i < its.problem.columns(); ++i) sum += step->x[i] * step->x[i];
    return std::sqrt(sum);
  };
  CHECK(length(restoring) < 1e-2 * length(newton));
  direction.reset();
  CHECK(direction.find(*its.run.current, 0.1, restoring.get()));
  CHECK(length(restoring) == length(newton));
}

ROBOTRAJ_TEST(second_order_steps_count_the_products_of_the_changes) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  interior_point::Room predictor(its.problem), step(its.problem);
  CHECK(its.run.direction.find(at, 0.0, predictor.get()));
  CHECK(its.run.direction.find(at, 0.0, step.get()));
  const double mu = its.run.mu;
  CHECK(its.run.direction.aim(at, mu, true, step.get()));
  for (int i = 0; i < 5; ++i) {
    const double product = predictor->lower[i] * predictor->s[i];
    const double linear = at.at->lower[i] * step->s[i] + at.below()[i] * step->lower[i];
    CHECK(std::abs(at.at->lower[i] * at.below()[i] + linear + product - mu) < 1e-6);
    if (i == 0) continue;  // no upper bound
    const double above = -predictor->upper[i] * predictor->s[i];
    const double linear_above = -at.at->upper[i] * step->s[i] + at.above()[i] * step->upper[i];
    CHECK(std::abs(at.at->upper[i] * at.above()[i] + linear_above + above - mu) < 1e-6);
  }
  // The products are those of this step alone.
  interior_point::Room plain(its.problem), again(its.problem);
  CHECK(its.run.direction.aim(at, mu, false, plain.get()));
  CHECK(its.run.direction.find(at, mu, again.get()));
  for (int i = 0; i < 5; ++i) CHECK(std::abs(again->s[i] - plain->s[i]) < 1e-6);
}

ROBOTRAJ_TEST(centring_moves_the_products_of_a_longer_step_into_their_range) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  interior_point::Room before(its.problem), step(its.problem);
  const double mu = 1e-3;
  CHECK(its.run.direction.find(at, mu, before.get()));
  CHECK(its.run.direction.find(at, mu, step.get()));
  CHECK(its.run.direction.center(at, 1.0, 1.0, 10.0, step.get()));
  int moved = 0;
  for (int i = 0; i < 5; ++i) {
    const double product = (at.at->lower[i] + before->lower[i]) * (at.below()[i] + before->s[i]);
    const double change = std::max(-10.0 * mu, std::clamp(product, 0.1 * mu, 10.0 * mu) - product);
    const double linear = at.at->lower[i] * step->s[i] + at.below()[i] * step->lower[i];
    CHECK(std::abs(at.at->lower[i] * at.below()[i] + linear - mu - change) < 1e-6);
    if (change != 0.0) ++moved;
    if (i == 0) continue;  // no upper bound
    const double above = (at.at->upper[i] + before->upper[i]) * (at.above()[i] - before->s[i]);
    const double change_above = std::max(-10.0 * mu, std::clamp(above, 0.1 * mu, 10.0 * mu) - above);
    const double linear_above = -at.at->upper[i] * step->s[i] + at.above()[i] * step->upper[i];
    CHECK(std::abs(at.at->upper[i] * at.above()[i] + linear_above - mu - change_above) < 1e-6);
  }
  CHECK(moved > 0);
}

ROBOTRAJ_TEST(corrections_solve_for_other_residuals_by_the_same_factors) {
  Started its;
  interior_point::Iterate& at = *its.run.current;
  interior_point::Room step(its.problem), again(its.problem);
  CHECK(its.run.direction.find(at, its.run.mu, step.get()));
  CHECK(its.run.direction.correct(at, at.residual(), again.get()));
  for (int i = 0; i < 4; ++i) CHECK(std::abs(again->x[i] - step->x[i]) < 1e-6);
  const double other[] = {1.0, -2.0, 3.0, 0.5, 0.0, -1.0};
  CHECK(its.run.direction.correct(at, other, again.get()));
  CHECK(left_of_rows(its, again, other) < 1e-6);
  // Another barrier parameter is another right-hand side.
  CHECK(its.run.direction.find(at, 0.01, step.get()));
  CHECK(its.run.direction.aim(at, its.run.mu, false, again.get()));
  CHECK(its.run.direction.find(at, its.run.mu, step.get()));
  for (int i = 0; i < 5; ++i) CHECK(std::abs(again->s[i] - step->s[i]) < 1e-6);
}

}  // namespace robotraj::tests
