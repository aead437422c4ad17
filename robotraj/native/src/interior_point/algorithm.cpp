#include "algorithm.hpp"

#include <cmath>
#include <ctime>

#include "restoration.hpp"

namespace robotraj::interior_point {

namespace {

constexpr double kSigma = 1e10;     // kappa_Sigma
constexpr double kFeasible = 1e-2;  // share of the tolerance

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

Algorithm::Algorithm(Problem& problem, const Options& options, Progress& progress)
    : run(problem, options), search(run), barrier(run), options_(options), progress_(progress), convergence_(options) {}

Algorithm::~Algorithm() = default;

bool Algorithm::out_of_time() const {
  return std::isfinite(options_.processor_limit) && processor_seconds() - began_ > options_.processor_limit;
}

End Algorithm::iterate(double mu) {
  began_ = processor_seconds();
  run.direction.reset();
  convergence_.reset();
  settled_ = false;
  barrier.start(mu);
  search.start();
  for (bool first = true;; first = false) {
    progress_.trace.push_back(line());
    if (!first && goal && goal()) return End::restored;
    if (!std::isfinite(run.current->barrier(run.mu)) || !std::isfinite(run.current->violation()))
      return End::invalid_number;
    switch (convergence_.check(*run.current)) {
      case Converged::solved: return End::solved;
      case Converged::acceptable: return End::acceptable;
      default: break;
    }
    if (!goal && settled()) {
      if (run.current->largest_violation() <= options_.tolerance) return End::settled;
      run.direction.only_restore();
    }
    if (progress_.check) progress_.check(progress_.iterations, progress_.trace.back()[0], progress_.trace.back()[1]);
    if (progress_.iterations >= options_.max_iterations) return End::iteration_limit;
    if (out_of_time()) return End::processor_limit;
    // A restoration phase takes its first step with the parameter it is given.
    if (!(first && goal) && barrier.update()) search.reset();
    const bool stepped = step();
    if (!stepped || !search.search()) {
      const End end = restore(stepped);
      if (end != End::restored) return end;
    }
    accept();
  }
}

bool Algorithm::settled() {
  Iterate& at = *run.current;
  if (settled_ || !convergence_.settled(at)) return settled_;
  convergence_.reset();
  settled_ = !convergence_.has_gap(at);
  settled_objective_ = at.objective();
  if (!settled_ && barrier.fall()) search.reset();
  return settled_;
}

bool Algorithm::step() {
  search.free = barrier.is_free();
  if (!search.free) return barrier.follow();
  search.reset();
  return barrier.choose();
}

End Algorithm::restore(bool stepped) {
  if (!restoration || run.current->largest_violation() <= kFeasible * options_.tolerance) {
    if (error(*run.current, 0.0) <= options_.acceptable_tolerance) return End::acceptable;
    return stepped ? End::line_search_failed : End::step_failed;
  }
  search.give_up();
  const End end = restoration().restore(run, search);
  // A restoration phase may end far from where the objective had settled.
  if (settled_ && end == End::restored && !convergence_.is_near(*run.trial, settled_objective_)) {
    settled_ = false;
    run.direction.reset();
  }
  return end;
}

void Algorithm::accept() {
  ++progress_.iterations;
  std::swap(run.current, run.trial);
  const native::Bounds bounds = run.problem.bounds();
  const VectorKernels& vectors = native::vector_kernels_of();
  Iterate& at = *run.current;
  vectors.clamp_duals(bounds.lower, at.below(), run.mu, kSigma, bounds.count, at.at->lower);
  vectors.clamp_duals(bounds.upper, at.above(), run.mu, kSigma, bounds.count, at.at->upper);
  at.turned();
}

}  // namespace robotraj::interior_point
