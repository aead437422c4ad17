#include "convergence.hpp"

#include <algorithm>
#include <cmath>

namespace robotraj::interior_point {

namespace {

constexpr double kLargestMean = 100.0;  // s_max
constexpr double kAdaptiveGap = 0.1;    // largest product of the adaptive rule, relative to the tolerance
constexpr std::size_t kUnchanged = 8;   // iterations
constexpr double kNear = 1e-2;          // share of an objective; the next mesh finds what less has cost
constexpr double kNearRows = 1e-2;      // violation from which few steps restore the rows

double mean(double sum, int count) { return count > 0 ? sum / count : 0.0; }

}  // namespace

double dual_error(Iterate& iterate, double mu) {
  const VectorKernels& run = native::vector_kernels_of();
  Problem& problem = iterate.problem();
  const int bounds = problem.bound_count(), slacks = problem.slacks();
  const double of_bounds = run.absolute_sum(iterate.at->lower, slacks) + run.absolute_sum(iterate.at->upper, slacks);
  const double of_rows = run.absolute_sum(iterate.at->rows, problem.rows());
  const double s_d = std::max(kLargestMean, mean(of_bounds + of_rows, bounds + problem.rows())) / kLargestMean;
  const double s_c = std::max(kLargestMean, mean(of_bounds, bounds)) / kLargestMean;
  const double complementarity = run.largest_complementarity(problem.bounds(), iterate.at->lower, iterate.below(),
                                                             iterate.at->upper, iterate.above(), mu);
  return std::max(iterate.largest_infeasibility() / s_d, complementarity / s_c);
}

double error(Iterate& iterate, double mu) { return std::max(dual_error(iterate, mu), iterate.largest_violation()); }

double system_error(Iterate& iterate, double mu) {
  const VectorKernels& run = native::vector_kernels_of();
  Problem& problem = iterate.problem();
  const int slacks = problem.slacks();
  const double dual = run.absolute_sum(iterate.infeasibility_x(), problem.columns()) +
                      run.absolute_sum(iterate.infeasibility_s(), slacks);
  double complementarity = 0.0;
  const double *below = iterate.below(), *above = iterate.above();
  for (int i = 0; i < slacks; ++i) {
    if (std::isfinite(problem.lower[i])) complementarity += std::abs(iterate.at->lower[i] * below[i] - mu);
    if (std::isfinite(problem.upper[i])) complementarity += std::abs(iterate.at->upper[i] * above[i] - mu);
  }
  return mean(dual, problem.columns() + slacks) + mean(iterate.violation(), problem.rows()) +
         mean(complementarity, problem.bound_count());
}

double mean_complementarity(Iterate& iterate) {
  Problem& problem = iterate.problem();
  const double *below = iterate.below(), *above = iterate.above();
  double sum = 0.0;
  // Multipliers of infinite bounds are zero.
  for (int i = 0; i < problem.slacks(); ++i) sum += iterate.at->lower[i] * below[i] + iterate.at->upper[i] * above[i];
  return mean(sum, problem.bound_count());
}

bool Convergence::close(Iterate& iterate) const {
  if (!options_.adaptive_barrier) return true;
  const double largest = native::vector_kernels_of().largest_complementarity(
      iterate.problem().bounds(), iterate.at->lower, iterate.below(), iterate.at->upper, iterate.above(), 0.0);
  return largest <= kAdaptiveGap * options_.tolerance;
}

bool Convergence::is_near(Iterate& iterate, double objective) const {
  return std::abs(iterate.objective() - objective) <= kNear * std::abs(objective);
}

bool Convergence::has_gap(Iterate& iterate) const {
  const double gap = mean_complementarity(iterate) * iterate.problem().bound_count();
  return gap > options_.objective_change * std::abs(iterate.objective());
}

Converged Convergence::check(Iterate& iterate) {
  const double now = error(iterate, 0.0);
  const bool feasible = iterate.largest_violation() <= options_.violation_tolerance;
  if (now <= options_.tolerance && feasible && close(iterate)) return Converged::solved;
  acceptable_ = now <= options_.acceptable_tolerance && feasible ? acceptable_ + 1 : 0;
  return acceptable_ >= options_.acceptable_iterations ? Converged::acceptable : Converged::no;
}

bool Convergence::settled(Iterate& iterate) {
  if (options_.objective_change == 0.0) return false;
  objectives_.push_back(iterate.objective());
  if (objectives_.size() > kUnchanged + 1) objectives_.pop_front();
  if (objectives_.size() <= kUnchanged || iterate.largest_violation() > kNearRows) return false;
  const auto [least, most] = std::minmax_element(objectives_.begin(), objectives_.end());
  return *most - *least <= options_.objective_change * std::abs(iterate.objective());
}

}  // namespace robotraj::interior_point
