#include "inertia_correction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "interior_point/problem/convergence.hpp"

namespace robotraj::interior_point {

using native::padded;

namespace {

constexpr double kLargest = 1e40, kLeast = 1e-20;  // delta_w^max, delta_w^min
constexpr double kGrowFirst = 100.0;
constexpr int kMostWaits = 2;
constexpr double kPower = 0.25;        // kappa_c
constexpr double kLeastProduct = 0.1;  // of a distance and its multiplier, relative to mu
constexpr double kFar = 1e4;           // delta_x of steps away from an optimum that only restore the rows
constexpr double kNear = 30.0;         // delta_x of steps that only restore the rows, relative to the tolerance

/// Adds the time from its construction to its destruction to a sum.
class Timed {
 public:
  explicit Timed(double& sum) : sum_(sum), began_(Clock::now()) {}
  ~Timed() { sum_ += std::chrono::duration<double>(Clock::now() - began_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& sum_;
  Clock::time_point began_;
};

}  // namespace

InertiaCorrection::InertiaCorrection(Problem& problem, const Options& options)
    : newton(problem),
      problem_(problem),
      options_(options),
      run_(native::vector_kernels_of()),
      memory_(6 * static_cast<std::size_t>(padded(problem.slacks()))) {
  Parts parts(memory_);
  for (double** each : {&s_, &lower_, &upper_, &damping_, &lower_products_, &upper_products_})
    *each = parts.take(problem.slacks());
}

Side InertiaCorrection::side(Iterate& iterate, double mu, const double* rows) {
  const native::Bounds bounds = problem_.bounds();
  const int n = problem_.slacks();
  // The part of the barrier's gradient that belongs to slacks with one bound alone.
  run_.barrier_gradient(bounds, iterate.below(), iterate.above(), 0.0, mu * Iterate::kappa_d, damping_);
  run_.add(iterate.infeasibility_s(), damping_, n, s_);
  run_.complementarity(bounds.lower, iterate.at->lower, iterate.below(), mu, n, lower_);
  run_.complementarity(bounds.upper, iterate.at->upper, iterate.above(), mu, n, upper_);
  if (second_order_) {
    run_.add(lower_, lower_products_, n, lower_);
    run_.add(upper_, upper_products_, n, upper_);
  }
  return {iterate.infeasibility_x(), rows, s_, lower_, upper_};
}

double InertiaCorrection::larger(double delta_w) const {
  if (delta_w > 0.0) return delta_w * (last_ == 0.0 ? kGrowFirst : options_.correction_increase);
  return last_ == 0.0 ? options_.first_correction : std::max(kLeast, options_.correction_decrease * last_);
}

double InertiaCorrection::proximal(Iterate& iterate) const {
  const double tolerance = options_.tolerance;
  if (only_restores_) return kFar;
  if (first_) return 0.0;
  return iterate.largest_violation() > tolerance && dual_error(iterate, 0.0) <= tolerance ? kNear * tolerance : 0.0;
}

bool InertiaCorrection::find(Iterate& iterate, double mu, const Vectors& step) {
  mu_ = mu;
  second_order_ = false;
  const Side side = this->side(iterate, mu, iterate.residual());
  const bool waits = waits_ > 0;
  if (waits) --waits_;
  problem_.hessian(iterate.at->x, iterate.at->rows, waits, newton.hessian());
  bool convex = waits || !problem_.saturates();
  newton.options = {options_.elimination_tolerance, options_.pivot_tolerance};
  const double root = std::pow(std::max(mu, options_.tolerance), kPower);
  const double delta_x = proximal(iterate);
  double delta_w = 0.0, delta_c = options_.least_row_correction * root;
  bool corrected = options_.row_correction <= options_.least_row_correction;
  const Timed timed(seconds);
  while (delta_w <= kLargest) {
    switch (newton.solve(iterate, side, delta_w + delta_x, delta_c, step)) {
      case Solved::indefinite:
        if (convex) {
          delta_w = larger(delta_w);
          break;
        }
        problem_.hessian(iterate.at->x, iterate.at->rows, true, newton.hessian());
        waits_ = std::min(++failures_, kMostWaits);
        convex = true;
        break;
      case Solved::dependent:
        if (!corrected) delta_c = options_.row_correction * root;
        else delta_w = larger(delta_w);
        corrected = true;
        break;
      case Solved::invalid: return false;
      default:
        if (delta_w > 0.0) last_ = delta_w;
        if (!convex) failures_ = 0;
        first_ = false;
        return true;
    }
  }
  return false;
}

bool InertiaCorrection::correct(Iterate& iterate, const double* rows, const Vectors& step) {
  const Side side = this->side(iterate, mu_, rows);
  const Timed timed(seconds);
  return newton.solve_again(iterate, side, step) != Solved::invalid;
}

bool InertiaCorrection::aim(Iterate& iterate, double mu, bool second_order, const Vectors& step) {
  mu_ = mu;
  second_order_ = second_order;
  for (int i = 0; second_order && i < problem_.slacks(); ++i) {
    // The distance from the upper bound changes by -ds.
    lower_products_[i] = step.lower[i] * step.s[i];
    upper_products_[i] = -step.upper[i] * step.s[i];
  }
  return correct(iterate, iterate.residual(), step);
}

bool InertiaCorrection::center(Iterate& iterate, double primal, double dual, double largest, const Vectors& step) {
  const native::Bounds bounds = problem_.bounds();
  const double least = kLeastProduct * mu_;
  largest *= mu_;
  if (!second_order_) {
    std::fill_n(lower_products_, problem_.slacks(), 0.0);
    std::fill_n(upper_products_, problem_.slacks(), 0.0);
    second_order_ = true;
  }
  const auto change = [&](double product) { return std::max(-largest, std::clamp(product, least, largest) - product); };
  for (int i = 0; i < problem_.slacks(); ++i) {
    const double ds = primal * step.s[i];
    if (std::isfinite(bounds.lower[i]))
      lower_products_[i] -= change((iterate.at->lower[i] + dual * step.lower[i]) * (iterate.below()[i] + ds));
    if (std::isfinite(bounds.upper[i]))
      upper_products_[i] -= change((iterate.at->upper[i] + dual * step.upper[i]) * (iterate.above()[i] - ds));
  }
  return correct(iterate, iterate.residual(), step);
}

}  // namespace robotraj::interior_point
