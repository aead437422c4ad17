#include "line_search.hpp"

#include <cmath>
#include <limits>

#include "interior_point/problem/convergence.hpp"

namespace robotraj::interior_point {

namespace {

constexpr double kGammaTheta = 1e-5, kGammaPhi = 1e-8, kEtaPhi = 1e-8, kDelta = 1.0, kPowerPhi = 2.3, kPowerTheta = 1.1,
                 kGammaAlpha = 0.05, kThetaMax = 1e4, kThetaMin = 1e-4;
constexpr double kReduction = 0.5;
constexpr double kFarther = 10.0;  // growth of the largest violation along a step that is taken without a test
constexpr int kCorrections = 4;
constexpr double kCorrectionGain = 0.99;  // kappa_soc
constexpr double kObjectiveGrowth = 5.0;  // powers of ten
constexpr int kWatchdogTrigger = 10, kWatchdogSteps = 3;
constexpr int kSoftSteps = 10;
constexpr int kClearingTrigger = 5, kClearings = 5;
constexpr double kSoftGain = 1.0 - 1e-4;

/// a <= b but for rounding in numbers of the size of `beside`.
bool at_most(double a, double b, double beside) {
  return a - b <= 10.0 * std::numeric_limits<double>::epsilon() * std::abs(beside);
}

double dot(const double* x, const double* y, int n) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += x[i] * y[i];
  return sum;
}

/// out = x + alpha step.
void along(const double* x, double alpha, const double* step, int n, double* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i] + alpha * step[i];
}

}  // namespace

void LineSearch::start() {
  theta_max_ = theta_min_ = -1.0;
  reset();
}

void LineSearch::reset() {
  filter_.clear();
  watching_ = soft_ = false;
  shortened_ = filtered_ = clearings_ = 0;
}

LineSearch::Reference LineSearch::reference_of(Iterate& iterate) {
  const Vectors& step = run_.step.get();
  const native::Bounds bounds = run_.problem.bounds();
  const double slope = dot(iterate.gradient_x(), step.x, run_.problem.columns()) +
                       dot(iterate.gradient_s(), step.s, run_.problem.slacks()) +
                       native::vector_kernels_of().barrier_slope(bounds, iterate.below(), iterate.above(), run_.mu,
                                                                 run_.mu * Iterate::kappa_d, step.s);
  return {iterate.violation(), iterate.barrier(run_.mu), slope};
}

double LineSearch::longest(const Vectors& step) const {
  Iterate& at = *run_.current;
  return native::vector_kernels_of().longest_step(run_.problem.bounds(), at.below(), at.above(), step.s, run_.tau());
}

double LineSearch::longest_dual(const Vectors& step) const {
  Iterate& at = *run_.current;
  return native::vector_kernels_of().longest_dual_step(run_.problem.bounds(), at.at->lower, step.lower, at.at->upper,
                                                       step.upper, run_.tau());
}

void LineSearch::move(double alpha, const Vectors& step) {
  const Vectors &from = run_.current->at.get(), &to = run_.trial->at.get();
  along(from.x, alpha, step.x, run_.problem.columns(), to.x);
  along(from.s, alpha, step.s, run_.problem.slacks(), to.s);
  run_.trial->moved();
}

void LineSearch::move_duals(double alpha, double alpha_rows, const Vectors& step) {
  const Vectors &from = run_.current->at.get(), &to = run_.trial->at.get();
  along(from.rows, alpha_rows, step.rows, run_.problem.rows(), to.rows);
  along(from.lower, alpha, step.lower, run_.problem.slacks(), to.lower);
  along(from.upper, alpha, step.upper, run_.problem.slacks(), to.upper);
  run_.trial->turned();
}

bool LineSearch::is_f_type(double alpha) const {
  const double m = reference_.slope;
  return m < 0.0 && alpha * std::pow(-m, kPowerPhi) > kDelta * std::pow(reference_.violation, kPowerTheta);
}

bool LineSearch::armijo(double alpha, double barrier) const {
  return at_most(barrier - reference_.barrier, kEtaPhi * alpha * reference_.slope, reference_.barrier);
}

bool LineSearch::improves(double violation, double barrier, bool far_allowed) const {
  const double growth = barrier - reference_.barrier;
  if (!far_allowed && growth > 0.0) {
    const double size = std::abs(reference_.barrier);
    if (std::log10(growth) > kObjectiveGrowth + (size > 10.0 ? std::log10(size) : 1.0)) return false;
  }
  return at_most(violation, (1.0 - kGammaTheta) * reference_.violation, reference_.violation) ||
         at_most(growth, -kGammaPhi * reference_.violation, reference_.barrier);
}

bool LineSearch::acceptable(double alpha) {
  const double violation = run_.trial->violation(), barrier = run_.trial->barrier(run_.mu);
  if (!std::isfinite(violation) || !std::isfinite(barrier) || violation > theta_max_) return false;
  const bool improved = alpha > 0.0 && is_f_type(alpha) && reference_.violation <= theta_min_
                            ? armijo(alpha, barrier)
                            : improves(violation, barrier, false);
  rejected_by_filter_ = improved && !filter_.accepts(violation, barrier);
  return improved && !rejected_by_filter_;
}

bool LineSearch::keeps_near() const {
  return std::isfinite(run_.trial->barrier(run_.mu)) &&
         run_.trial->largest_violation() <= kFarther * run_.current->largest_violation();
}

bool LineSearch::accepts(double violation, double barrier) const {
  return std::isfinite(violation) && std::isfinite(barrier) && improves(violation, barrier, true) &&
         filter_.accepts(violation, barrier);
}

void LineSearch::add_reference() {
  filter_.add((1.0 - kGammaTheta) * reference_.violation, reference_.barrier - kGammaPhi * reference_.violation);
}

double LineSearch::shortest() const {
  const double theta = reference_.violation, m = reference_.slope;
  double alpha = kGammaTheta;
  if (m < 0.0) {
    alpha = std::min(alpha, kGammaPhi * theta / -m);
    if (theta <= theta_min_) alpha = std::min(alpha, kDelta * std::pow(theta, kPowerTheta) / std::pow(-m, kPowerPhi));
  }
  return kGammaAlpha * alpha;
}

bool LineSearch::correct(double alpha) {
  Run& run = run_;
  const int rows = run.problem.rows();
  const double* c = run.current->residual();
  corrected_rows_.assign(c, c + rows);
  double before = 0.0, now = run.trial->violation(), length = alpha;
  for (int count = 0; count < kCorrections && (count == 0 || now <= kCorrectionGain * before); ++count) {
    before = now;
    const double* there = run.trial->residual();
    for (int i = 0; i < rows; ++i)
      corrected_rows_[static_cast<std::size_t>(i)] = there[i] + length * corrected_rows_[static_cast<std::size_t>(i)];
    const Vectors& step = correction_.get();
    if (!run.direction.correct(*run.current, corrected_rows_.data(), step)) return false;
    length = longest(step);
    move(length, step);
    if (run.trial->violation() < reference_.violation && acceptable(alpha)) {
      move_duals(longest_dual(step), length, step);
      corrected_ = true;
      return true;
    }
    now = run.trial->violation();
    if (!std::isfinite(now)) return false;
  }
  return false;
}

bool LineSearch::backtrack(bool skip_first, int& shortenings) {
  const Vectors& step = run_.step.get();
  const double longest_step = longest(step), least = shortest();
  const double tested = watching_ ? watched_alpha_ : longest_step;
  double alpha = longest_step;
  shortenings = 0;
  bool filtered = false;
  corrected_ = false;
  if (skip_first) alpha *= kReduction, shortenings = 1;
  for (; shortenings == 0 || alpha > least; alpha *= kReduction, ++shortenings) {
    const double test = watching_ ? tested : alpha;
    move(alpha, step);
    bool accepted = acceptable(test) || (free && shortenings == 0 && keeps_near());
    if (!accepted && watching_) return false;
    if (!accepted && shortenings == 0 && run_.trial->violation() >= run_.current->violation() &&
        std::isfinite(run_.trial->violation()))
      accepted = correct(alpha);
    if (!accepted) {
      filtered = rejected_by_filter_;
      continue;
    }
    filtered_ = filtered ? filtered_ + 1 : 0;
    if (!corrected_) move_duals(longest_dual(step), alpha, step);
    if (!is_f_type(test) || !armijo(test, run_.trial->barrier(run_.mu))) add_reference();
    return true;
  }
  return false;
}

void LineSearch::start_watchdog() {
  if (!watched_iterate_) {
    watched_iterate_ = std::make_unique<Iterate>(run_.problem);
    watched_step_ = std::make_unique<Room>(run_.problem);
  }
  watching_ = true;
  watched_ = 0;
  watched_reference_ = reference_;
  watched_alpha_ = longest(run_.step.get());
  watched_iterate_->copy(*run_.current);
  watched_step_->copy(run_.step);
}

void LineSearch::stop_watchdog() {
  watching_ = false;
  shortened_ = 0;
  run_.current->copy(*watched_iterate_);
  run_.step.copy(*watched_step_);
  reference_ = watched_reference_;
}

bool LineSearch::soft_step(bool& acceptable_again) {
  const Vectors& step = run_.step.get();
  const double alpha = std::min(longest(step), longest_dual(step));
  move(alpha, step);
  move_duals(alpha, alpha, step);
  acceptable_again = acceptable(0.0);
  if (acceptable_again) return true;
  if (!std::isfinite(run_.trial->barrier(run_.mu))) return false;
  return system_error(*run_.trial, run_.mu) <= kSoftGain * system_error(*run_.current, run_.mu);
}

void LineSearch::give_up() {
  if (!soft_) {
    reference_ = {run_.current->violation(), run_.current->barrier(run_.mu), 0.0};
    add_reference();
  }
  soft_ = watching_ = false;
  shortened_ = 0;
}

bool LineSearch::search() {
  reference_ = watching_ ? watched_reference_ : reference_of(*run_.current);
  if (theta_max_ < 0.0) {
    theta_max_ = kThetaMax * std::max(1.0, reference_.violation);
    theta_min_ = kThetaMin * std::max(1.0, reference_.violation);
  }
  bool acceptable_again = false;
  if (soft_) {
    if (++soft_steps_ > kSoftSteps || !soft_step(acceptable_again)) return false;
    if (acceptable_again) soft_ = false;
    return true;
  }
  if (!watching_ && shortened_ >= kWatchdogTrigger) start_watchdog();
  if (filtered_ >= kClearingTrigger && clearings_ < kClearings) {
    filter_.clear();
    filtered_ = 0;
    ++clearings_;
  }
  int shortenings = 0;
  bool accepted = backtrack(false, shortenings);
  if (watching_) {
    if (accepted) {
      watching_ = false;
      shortened_ = 0;
      return true;
    }
    const bool defined = std::isfinite(run_.trial->barrier(run_.mu)) && std::isfinite(run_.trial->violation());
    if (++watched_ <= kWatchdogSteps && defined) {
      const Vectors& step = run_.step.get();
      move_duals(longest_dual(step), longest(step), step);
      return true;
    }
    stop_watchdog();
    accepted = backtrack(true, shortenings);
  }
  if (accepted) {
    shortened_ = shortenings > 0 ? shortened_ + 1 : 0;
    return true;
  }
  if (run_.current->violation() == 0.0) return false;
  add_reference();
  soft_ = true;
  soft_steps_ = 0;
  if (!soft_step(acceptable_again)) return false;
  if (acceptable_again) soft_ = false;
  return true;
}

}  // namespace robotraj::interior_point
