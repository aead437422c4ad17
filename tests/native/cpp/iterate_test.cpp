// Functions of a point against their definitions and finite differences, of the problem and of its restoration.
#include <cmath>
#include <random>

#include "check.hpp"
#include "interior_point/problem/feasibility.hpp"

namespace robotraj::tests {
namespace {

using interior_point::Iterate;
using interior_point::Problem;

/// Writes [x, s] into an iterate.
void place(Iterate& at, const std::vector<double>& variables) {
  const auto columns = static_cast<std::size_t>(at.problem().columns());
  for (std::size_t i = 0; i < variables.size(); ++i) (i < columns ? at.at->x[i] : at.at->s[i - columns]) = variables[i];
  at.moved();
}

/// f + lam' c - z_l' (s - lower) - z_u' (upper - s).
double lagrangian(Iterate& at) {
  const Problem& problem = at.problem();
  double sum = at.objective();
  for (int i = 0; i < problem.rows(); ++i) sum += at.at->rows[i] * at.residual()[i];
  for (int i = 0; i < problem.slacks(); ++i) sum -= at.at->lower[i] * at.below()[i] + at.at->upper[i] * at.above()[i];
  return sum;
}

void check_gradient(Problem& problem, std::mt19937& random) {
  std::uniform_real_distribution<double> inside(1.5, 4.5), sign(-1.0, 1.0);
  const auto columns = static_cast<std::size_t>(problem.columns()), slacks = static_cast<std::size_t>(problem.slacks());
  Iterate at(problem);
  for (int i = 0; i < problem.rows(); ++i) at.at->rows[i] = sign(random);
  for (std::size_t i = 0; i < slacks; ++i) {
    at.at->lower[i] = std::isfinite(problem.lower[i]) ? std::abs(sign(random)) : 0.0;
    at.at->upper[i] = std::isfinite(problem.upper[i]) ? std::abs(sign(random)) : 0.0;
  }
  std::vector<double> variables(columns + slacks), step(variables.size());
  for (double& each : variables) each = inside(random);
  for (double& each : step) each = sign(random);
  const double expected = slope(
      [&](const std::vector<double>& there) {
        place(at, there);
        return lagrangian(at);
      },
      variables, step);
  place(at, variables);
  at.turned();
  double found = 0.0;
  for (std::size_t i = 0; i < columns; ++i) found += at.infeasibility_x()[i] * step[i];
  for (std::size_t i = 0; i < slacks; ++i) found += at.infeasibility_s()[i] * step[columns + i];
  CHECK(std::abs(found - expected) < 1e-5 * std::max(1.0, std::abs(expected)));
}

}  // namespace

ROBOTRAJ_TEST(gradients_of_the_lagrangian_are_those_of_finite_differences) {
  Started its(its_start, 0.1, 0.5);
  std::mt19937 random(3);
  interior_point::Feasibility feasibility(its.problem);
  feasibility.start_from(its_start.data());
  feasibility.set_barrier(0.04);
  for (int round = 0; round < 5; ++round) {
    check_gradient(its.problem, random);
    check_gradient(feasibility, random);
  }
}

ROBOTRAJ_TEST(the_barrier_function_and_the_violation_are_their_definitions) {
  Started its;
  Iterate& at = *its.run.current;
  place(at, {2.0, 3.0, 4.0, 1.5, 30.0, 2.5, 3.5, 4.5, 1.5});
  // The product has no upper bound, so its slack carries kappa_d too.
  double expected = 2.0 * 1.5 * 9.0 + 4.0 + its.run.mu * (Iterate::kappa_d * 5.0 - std::log(5.0));
  for (const double s : {2.5, 3.5, 4.5, 1.5}) expected -= its.run.mu * (std::log(s - 1.0) + std::log(5.0 - s));
  CHECK(std::abs(at.barrier(its.run.mu) - expected) < 1e-12 * expected);
  // |x|^2 = 31.25, the product is 36.
  CHECK(std::abs(at.violation() - (8.75 + 6.0 + 0.5 + 0.5 + 0.5)) < 1e-12);
  CHECK(std::abs(at.largest_violation() - 8.75) < 1e-12);
}

ROBOTRAJ_TEST(the_restoration_problem_is_its_definition) {
  Started its;
  interior_point::Feasibility feasibility(its.problem);
  feasibility.start_from(its_start.data());
  feasibility.set_barrier(0.25);
  Iterate at(feasibility);
  const int relaxed = feasibility.relaxed(), p = feasibility.first_p(), n = feasibility.first_n();
  CHECK(relaxed == 6 && p == 5 && n == 11 && feasibility.slacks() == 17);
  std::vector<double> variables = {2.0, 3.0, 4.0, 1.5, 30.0, 2.5, 3.5, 4.5, 1.5};
  for (int i = 0; i < 2 * relaxed; ++i) variables.push_back(0.1 * (i + 1));
  place(at, variables);
  Iterate original(its.problem);
  place(original, {variables.begin(), variables.begin() + 9});
  for (int i = 0; i < relaxed; ++i)
    CHECK(std::abs(at.residual()[i] - (original.residual()[i] - at.at->s[p + i] + at.at->s[n + i])) < 1e-12);
  // rho sum(p + n) + sqrt(mu) / 2 |D_R (x - x_R)|^2 with x_R = (1, 5, 5, 1).
  const double expected = 1000.0 * 7.8 + 0.25 * (1.0 + 4.0 / 25.0 + 1.0 / 25.0 + 0.25);
  CHECK(std::abs(at.objective() - expected) < 1e-9);
}

}  // namespace robotraj::tests
