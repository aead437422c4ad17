#include "restoration.hpp"

#include <algorithm>
#include <cmath>

namespace robotraj::interior_point {

namespace {

// kappa_resto. With the paper's 0.9, the line search gives up again beside the points where it did before: swing-ups of
// the acrobot take twice as many iterations.
constexpr double kGain = 0.02;
constexpr double kLargestMultiplier = 1e3;  // multipliers of bounds above it are set to 1
constexpr double kInfeasible = 1e2;         // times the tolerance

}  // namespace

Restoration::Restoration(ProgramProblem& original, const Options& options, Progress& progress)
    : options_(options), problem_(original), algorithm_(problem_, options, progress) {}

/// p and n solve the barrier problem at c(x, s) by themselves:
///
///     n = a + sqrt(a^2 + mu c / (2 rho)),   a = (mu - rho c) / (2 rho),   p = c + n,
///
/// with multipliers mu / p and mu / n. Those of the rows start at zero: their own, rho - mu / p, would make the curvature
/// of the rows outweigh the distance from the start.
void Restoration::start(Run& original) {
  Iterate& from = *original.current;
  Run& run = algorithm_.run;
  problem_.start_from(from.at->x);
  const Vectors& at = run.current->at.get();
  const int own = problem_.layout().slacks, dynamics = problem_.layout().equality_rows;
  const double* c = from.residual() + dynamics;
  const double mu = std::max(original.mu, from.largest_violation()), rho = Feasibility::rho;
  std::copy_n(from.at->x, problem_.columns(), at.x);
  std::copy_n(from.at->s, own, at.s);
  for (int i = 0; i < own; ++i) {
    at.lower[i] = std::min(rho, from.at->lower[i]);
    at.upper[i] = std::min(rho, from.at->upper[i]);
  }
  std::fill_n(at.rows, problem_.rows(), 0.0);
  for (int i = 0; i < problem_.relaxed(); ++i) {
    const double a = (mu - rho * c[i]) / (2.0 * rho);
    const double n = a + std::sqrt(a * a + mu * c[i] / (2.0 * rho)), p = c[i] + n;
    at.s[problem_.first_p() + i] = p;
    at.s[problem_.first_n() + i] = n;
    at.lower[problem_.first_p() + i] = mu / p;
    at.lower[problem_.first_n() + i] = mu / n;
  }
  std::fill_n(at.upper + own, 2 * problem_.relaxed(), 0.0);
  run.mu = mu;
  run.current->moved();
}

void Restoration::take_point(Run& original) {
  const Vectors &from = algorithm_.run.current->at.get(), &to = original.trial->at.get();
  std::copy_n(from.x, problem_.columns(), to.x);
  std::copy_n(from.s, problem_.layout().slacks, to.s);
  original.trial->moved();
}

/// Moves the multipliers z of the bounds by Newton's step of z d = mu for the change of the slacks' distances d,
///
///     dz = (mu - z dd) / d - z,
///
/// and sets those of the rows to zero.
void Restoration::step_duals(Run& original) const {
  Iterate &from = *original.current, &to = *original.trial;
  const VectorKernels& vectors = native::vector_kernels_of();
  const int own = problem_.layout().slacks;
  Numbers lower(own), upper(own);
  for (int i = 0; i < own; ++i) {
    const double ds = to.at->s[i] - from.at->s[i];
    const double z_lower = from.at->lower[i], z_upper = from.at->upper[i];
    if (std::isfinite(original.problem.lower[i])) lower[i] = (original.mu - z_lower * ds) / from.below()[i] - z_lower;
    if (std::isfinite(original.problem.upper[i])) upper[i] = (original.mu + z_upper * ds) / from.above()[i] - z_upper;
  }
  const double alpha = vectors.longest_dual_step(original.problem.bounds(), from.at->lower, lower.data(),
                                                 from.at->upper, upper.data(), original.tau());
  double most = 0.0;
  for (int i = 0; i < own; ++i) {
    to.at->lower[i] = from.at->lower[i] + alpha * lower[i];
    to.at->upper[i] = from.at->upper[i] + alpha * upper[i];
    most = std::max({most, to.at->lower[i], to.at->upper[i]});
  }
  if (!(most <= kLargestMultiplier)) {
    for (int i = 0; i < own; ++i) {
      to.at->lower[i] = std::isfinite(original.problem.lower[i]) ? 1.0 : 0.0;
      to.at->upper[i] = std::isfinite(original.problem.upper[i]) ? 1.0 : 0.0;
    }
  }
  std::fill_n(to.at->rows, original.problem.rows(), 0.0);
  to.turned();
}

End Restoration::restore(Run& original, const LineSearch& search) {
  const double before = original.current->violation();
  start(original);
  algorithm_.goal = [&] {
    take_point(original);
    return original.trial->violation() <= kGain * before &&
           search.accepts(original.trial->violation(), original.trial->barrier(original.mu));
  };
  algorithm_.line = [&] {
    take_point(original);
    return Iteration{original.trial->objective(), original.trial->largest_violation(),
                     algorithm_.run.current->largest_infeasibility(), algorithm_.run.mu};
  };
  const End end = algorithm_.iterate(algorithm_.run.mu);
  switch (end) {
    case End::restored: step_duals(original); return end;
    case End::solved:
    case End::acceptable:
      take_point(original);
      return original.trial->largest_violation() > kInfeasible * options_.tolerance ? End::infeasible
                                                                                    : End::line_search_failed;
    case End::step_failed: return End::line_search_failed;
    default: return end;
  }
}

}  // namespace robotraj::interior_point
