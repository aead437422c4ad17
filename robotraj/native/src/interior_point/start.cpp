#include "start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robotraj::interior_point {

namespace {

constexpr double kLargestMultiplier = 1e3;

/// Sets the slacks to the values d(x) of the inequality rows, the residual d(x) - s at s = 0.
void rows_into_slacks(Run& run) {
  const Vectors& at = run.current->at.get();
  std::fill_n(at.s, run.problem.slacks(), 0.0);
  run.current->moved();
  const double* rows = run.current->residual() + run.problem.layout().inequality_rows;
  std::copy_n(rows, run.problem.slacks(), at.s);
  run.current->moved();
}

double pushed(double s, double lower, double upper, const Options& options) {
  const double range =
      std::isfinite(lower) && std::isfinite(upper) ? upper - lower : std::numeric_limits<double>::infinity();
  const auto room = [&](double bound) {
    return std::min(options.bound_push * std::max(1.0, std::abs(bound)), options.bound_fraction * range);
  };
  if (std::isfinite(lower)) s = std::max(s, lower + room(lower));
  if (std::isfinite(upper)) s = std::min(s, upper - room(upper));
  return s;
}

/// Moves a distance and its multiplier onto distance * multiplier >= mu, at most `room` from the bound.
void onto_path(double& distance, double& multiplier, double mu, double room) {
  const double root = std::sqrt(mu);
  if (distance * multiplier < mu || distance <= 0.0) {
    if (multiplier >= root && multiplier > distance) distance = mu / multiplier;
    else if (distance >= root) multiplier = mu / distance;
    else distance = multiplier = root;
  }
  if (distance > room) distance = room;
}

/// A slack and the multipliers of its bounds.
struct Slack {
  double s, lower, upper;
};

Slack onto_path(Slack slack, double lower, double upper, double mu) {
  const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
  const double room = has_lower && has_upper ? 0.5 * (upper - lower) : std::numeric_limits<double>::infinity();
  // The nearer bound moves the slack; the other one's multiplier then follows the distance that is left.
  const bool lower_first = has_lower && (!has_upper || slack.s - lower <= upper - slack.s);
  for (const bool is_lower : {lower_first, !lower_first}) {
    if (!(is_lower ? has_lower : has_upper)) continue;
    double distance = is_lower ? slack.s - lower : upper - slack.s;
    double& multiplier = is_lower ? slack.lower : slack.upper;
    if (is_lower == lower_first) {
      onto_path(distance, multiplier, mu, room);
      slack.s = is_lower ? lower + distance : upper - distance;
    } else {
      multiplier = std::max(multiplier, mu / distance);
    }
  }
  if (!has_lower) slack.lower = 0.0;
  if (!has_upper) slack.upper = 0.0;
  return slack;
}

}  // namespace

void estimate_multipliers(Run& run, double most) {
  Problem& problem = run.problem;
  Iterate& current = *run.current;
  const auto slacks = static_cast<std::size_t>(problem.slacks());
  Numbers none(std::max(slacks, static_cast<std::size_t>(problem.rows())), 0.0), of_slacks(slacks);
  for (std::size_t i = 0; i < slacks; ++i)
    of_slacks[i] = current.gradient_s()[i] - current.at->lower[i] + current.at->upper[i];
  const Side side{current.gradient_x(), none.data(), of_slacks.data(), none.data(), none.data()};
  Newton& newton = run.direction.newton;
  newton.options = {run.options.elimination_tolerance, run.options.pivot_tolerance};
  Solved solved = newton.least_squares(current, side, 0.0, run.step.get());
  if (solved == Solved::dependent)
    solved = newton.least_squares(current, side, run.options.row_correction, run.step.get());
  const bool usable = (solved == Solved::good || solved == Solved::inaccurate) &&
                      native::vector_kernels_of().largest(run.step->rows, problem.rows()) <= most;
  if (usable) std::copy_n(run.step->rows, problem.rows(), current.at->rows);
  else std::fill_n(current.at->rows, problem.rows(), 0.0);
  current.turned();
}

void start_cold(Run& run, const double* x) {
  const Problem& problem = run.problem;
  const Vectors& at = run.current->at.get();
  std::copy_n(x, problem.columns(), at.x);
  rows_into_slacks(run);
  for (int i = 0; i < problem.slacks(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    at.s[i] = pushed(at.s[i], problem.lower[k], problem.upper[k], run.options);
    at.lower[i] = std::isfinite(problem.lower[k]) ? 1.0 : 0.0;
    at.upper[i] = std::isfinite(problem.upper[k]) ? 1.0 : 0.0;
  }
  run.current->moved();
  estimate_multipliers(run, kLargestMultiplier);
}

void start_warm(Run& run, const double* x, const Known& known) {
  const Problem& problem = run.problem;
  const Vectors& at = run.current->at.get();
  std::copy_n(x, problem.columns(), at.x);
  std::copy_n(known.rows, problem.rows(), at.rows);
  rows_into_slacks(run);
  for (int i = 0; i < problem.slacks(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Slack slack =
        onto_path({at.s[i], known.lower[i], known.upper[i]}, problem.lower[k], problem.upper[k], run.mu);
    at.s[i] = slack.s;
    at.lower[i] = slack.lower;
    at.upper[i] = slack.upper;
  }
  run.current->moved();
}

}  // namespace robotraj::interior_point
