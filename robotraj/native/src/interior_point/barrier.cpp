#include "barrier.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "interior_point/problem/convergence.hpp"

namespace robotraj::interior_point {

namespace {

constexpr double kComplementarityTolerance = 1e-4;
constexpr double kMostMargin = 100.0;  // a smaller last parameter would take more iterations for nothing
constexpr std::size_t kRemembered = 4;
constexpr double kProgress = 0.9, kFixed = 0.8, kLargestBarrier = 1e5;
constexpr double kAsLong = 0.9;  // share of the predictor's length that a corrected step keeps
constexpr double kGain = 0.1;    // share of `longer` by which one of a centred step's lengths must grow,
constexpr double kLoss = 0.99;   // and the least ratio of the other one
constexpr double kShort = 0.9;   // length below which a step is centred
constexpr double kMost = 10.0;   // largest products it aims at, relative to mu
constexpr Centring kOfAdaptive{4, 0.3}, kOfMonotone{2, 0.4};
constexpr double kSmall = 1e-2;  // larger first parameters keep iterates away from bounds

}  // namespace

void Barrier::start(double mu) {
  free_ = true;
  errors_.clear();
  // Without stages a solution takes a tenth of a factorisation.
  const bool cheap = run_.problem.layout().count() == 1 && run_.options.initial_barrier <= kSmall;
  run_.leaves_more = !run_.options.adaptive_barrier && cheap;
  run_.set_barrier(mu);
}

double Barrier::least() const {
  return std::min(run_.options.tolerance, kComplementarityTolerance) /
         (std::min(run_.options.barrier_factor, kMostMargin) + 1.0);
}

bool Barrier::fall() {
  const Options& options = run_.options;
  const double next =
      std::max(least(), std::min(options.barrier_decrease * run_.mu, std::pow(run_.mu, options.barrier_power)));
  if (is_free() || !(next < run_.mu)) return false;
  run_.set_barrier(next);
  return true;
}

bool Barrier::decrease() {
  bool changed = false;
  while (error(*run_.current, run_.mu) <= run_.options.barrier_factor * run_.mu && fall()) changed = true;
  return changed;
}

bool Barrier::update() {
  if (!run_.options.adaptive_barrier) return decrease();
  const double now = error(*run_.current, 0.0);
  const bool progress =
      errors_.size() < kRemembered || now <= kProgress * *std::max_element(errors_.begin(), errors_.end());
  if (progress) {
    errors_.push_back(now);
    if (errors_.size() > kRemembered) errors_.pop_front();
    const bool changed = !free_;
    free_ = true;
    return changed;
  }
  if (!free_) return decrease();
  free_ = false;
  run_.set_barrier(std::max(least(), kFixed * mean_complementarity(*run_.current)));
  return true;
}

bool Barrier::choose() {
  if (!second_order_step()) return false;
  center(kOfAdaptive);
  return true;
}

bool Barrier::follow() {
  if (!run_.direction.find(*run_.current, run_.mu, run_.step.get())) return false;
  if (run_.options.adaptive_barrier) center(kOfAdaptive);
  else if (run_.leaves_more) center(kOfMonotone);
  return true;
}

void Barrier::center(const Centring& how) {
  Run& run = run_;
  Iterate& at = *run.current;
  const VectorKernels& vectors = native::vector_kernels_of();
  const native::Bounds bounds = run.problem.bounds();
  const double tau = run.tau();
  const Vectors& step = run.step.get();
  const auto lengths = [&] {
    return std::pair{vectors.longest_step(bounds, at.below(), at.above(), step.s, tau),
                     vectors.longest_dual_step(bounds, at.at->lower, step.lower, at.at->upper, step.upper, tau)};
  };
  auto [primal, dual] = lengths();
  for (int count = 0; count < how.times && std::min(primal, dual) < kShort; ++count) {
    if (!before_) before_ = std::make_unique<Room>(run.problem);
    before_->copy(run.step);
    bool better =
        run.direction.center(at, std::min(1.0, primal + how.longer), std::min(1.0, dual + how.longer), kMost, step);
    const auto [of_primal, of_dual] = lengths();
    const bool gains = of_primal >= primal + kGain * how.longer || of_dual >= dual + kGain * how.longer;
    better = better && gains && of_primal >= kLoss * primal && of_dual >= kLoss * dual;
    if (!better) return run.step.copy(*before_);
    primal = of_primal;
    dual = of_dual;
  }
}

bool Barrier::second_order_step() {
  Run& run = run_;
  const VectorKernels& vectors = native::vector_kernels_of();
  Iterate& at = *run.current;
  if (!run.direction.find(at, 0.0, run.step.get())) return false;
  const double mean = mean_complementarity(at);
  const native::Bounds bounds = run.problem.bounds();
  const double primal = vectors.longest_step(bounds, at.below(), at.above(), run.step->s, 1.0);
  const double dual =
      vectors.longest_dual_step(bounds, at.at->lower, run.step->lower, at.at->upper, run.step->upper, 1.0);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < run.problem.slacks(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double ds = primal * run.step->s[i];
    if (std::isfinite(run.problem.lower[k])) {
      sum += (at.at->lower[i] + dual * run.step->lower[i]) * (at.below()[i] + ds);
      ++count;
    }
    if (std::isfinite(run.problem.upper[k])) {
      sum += (at.at->upper[i] + dual * run.step->upper[i]) * (at.above()[i] - ds);
      ++count;
    }
  }
  if (count == 0) return run.direction.aim(at, run.mu, false, run.step.get());
  const double sigma = std::min(1.0, std::pow(sum / count / mean, 3));
  run.set_barrier(std::min(kLargestBarrier, std::max(least(), sigma * mean)));
  // At the least parameter Newton's own step converges; a corrected one need not descend.
  if (run.mu <= least()) return run.direction.aim(at, run.mu, false, run.step.get());
  if (!run.direction.aim(at, run.mu, true, run.step.get())) return false;
  const double tau = run.tau();
  const bool as_long = vectors.longest_step(bounds, at.below(), at.above(), run.step->s, tau) >= kAsLong * primal &&
                       vectors.longest_dual_step(bounds, at.at->lower, run.step->lower, at.at->upper, run.step->upper,
                                                 tau) >= kAsLong * dual;
  return as_long || run.direction.aim(at, run.mu, false, run.step.get());
}

}  // namespace robotraj::interior_point
