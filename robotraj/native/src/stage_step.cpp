#include "stage_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robotraj::native {

namespace {

constexpr int kRounds = 5;

/// Residual that is small enough beside a right-hand side of size b.
double tolerance(double b) { return std::max({1e-8, 1e-8 * b, 1e-6 * std::min(b, 1.0)}); }

/// fatrop gives its vectors for reading alone; the step's are written here.
double* writable(const fatrop::VecRealView& vector) { return const_cast<double*>(vector.data()); }

}  // namespace

StageStep::StageStep(StageParts& parts) : parts_(parts), run_(parts.vectors()) {
  const StageMatrices::Info& info = parts.info();
  columns_ = info.number_of_primal_variables;
  rows_ = info.number_of_eq_constraints;
  slacks_ = info.number_of_slack_variables;
  first_slack_row_ = info.offset_g_eq_slack;
  first_path_row_ = info.offset_g_eq_path;
  const auto part = [](int n) { return static_cast<std::size_t>(padded(n)); };
  memory_.resize(3 * (part(columns_) + part(rows_) + 3 * part(slacks_)) + 3 * part(slacks_) + part(rows_));
  double* at = memory_.data();
  residual_ = take(at);
  correction_ = take(at);
  better_ = take(at);
  for (double** each : {&inverse_, &gradient_, &weights_, &rows_reduced_}) {
    *each = at;
    at += padded(slacks_);
  }
}

StageStep::Step StageStep::take(double*& at) const {
  const auto part = [&at](int n) {
    double* here = at;
    at += padded(n);
    return here;
  };
  return {part(columns_), part(rows_), part(slacks_), part(slacks_), part(slacks_)};
}

SlackSystem StageStep::slacks(const Iterate& iterate) const {
  Iterate& known = const_cast<Iterate&>(iterate);  // evaluated already
  return {known.delta_lower().data(),     known.delta_upper().data(),      iterate.dual_bounds_l().data(),
          iterate.dual_bounds_u().data(), iterate.Dx().data() + columns_, iterate.De().data() + first_slack_row_};
}

void StageStep::prepare(Iterate& iterate) {
  side_ = {iterate.dual_infeasibility_x().data(), iterate.constr_viol().data(), iterate.dual_infeasibility_s().data(),
           iterate.relaxed_complementarity_l().data(), iterate.relaxed_complementarity_u().data()};
  size_ = std::max({iterate.dual_infeasibility_x_inf(), iterate.constr_viol_inf(),
                    iterate.dual_infeasibility_s_inf(), run_.largest(side_.lower, slacks_),
                    run_.largest(side_.upper, slacks_)});
}

void StageStep::reduce(const Iterate& iterate, const Side& side) {
  std::copy_n(side.rows, rows_, rows_reduced_);
  run_.reduce(slacks(iterate), {side.s, side.lower, side.upper, side.rows + first_slack_row_}, slacks_, inverse_,
              gradient_, weights_, rows_reduced_ + first_slack_row_);
}

void StageStep::recover(const Iterate& iterate, const Side& side, const Step& step) const {
  run_.recover(slacks(iterate), {side.s, side.lower, side.upper, nullptr}, inverse_, gradient_,
               step.rows + first_slack_row_, slacks_, {step.s, step.lower, step.upper});
}

void StageStep::solve_again(Iterate& iterate, const Side& side, const Step& step) {
  reduce(iterate, side);
  const double* relaxation = iterate.De_is_zero() ? nullptr : iterate.De().data() + first_path_row_;
  parts_.solve_again(iterate.jacobian(), {nullptr, relaxation, weights_, side.x, rows_reduced_, step.x, step.rows});
  recover(iterate, side, step);
}

double StageStep::residual(Iterate& iterate, const Step& step) {
  const double* relaxation = iterate.De_is_zero() ? nullptr : iterate.De().data() + first_path_row_;
  const double of_stages = parts_.residual(iterate.jacobian(), iterate.hessian(),
                                           {iterate.Dx().data(), relaxation, nullptr, side_.x, side_.rows, step.x,
                                            step.rows},
                                           residual_.x, residual_.rows);
  const double of_slacks = run_.slack_residual(
      slacks(iterate), {side_.s, side_.lower, side_.upper, nullptr}, {step.s, step.lower, step.upper},
      step.rows + first_slack_row_, slacks_, {residual_.s, residual_.lower, residual_.upper},
      residual_.rows + first_slack_row_);
  return std::max({of_stages, of_slacks, run_.largest(residual_.rows + first_slack_row_, slacks_)});
}

bool StageStep::finite(const Step& step) const {
  return run_.finite(step.x, columns_) && run_.finite(step.rows, rows_) && run_.finite(step.s, slacks_) &&
         run_.finite(step.lower, slacks_) && run_.finite(step.upper, slacks_);
}

void StageStep::add(const Step& first, const Step& second, const Step& sum) const {
  run_.add(first.x, second.x, columns_, sum.x);
  run_.add(first.rows, second.rows, rows_, sum.rows);
  run_.add(first.s, second.s, slacks_, sum.s);
  run_.add(first.lower, second.lower, slacks_, sum.lower);
  run_.add(first.upper, second.upper, slacks_, sum.upper);
}

fatrop::LinsolReturnFlag StageStep::solve(Iterate& iterate) {
  using fatrop::LinsolReturnFlag;
  const Step step{writable(iterate.delta_primal_x()), writable(iterate.delta_dual_eq()),
                  writable(iterate.delta_primal_s()), writable(iterate.delta_dual_bounds_l()),
                  writable(iterate.delta_dual_bounds_u())};
  reduce(iterate, side_);
  const double* relaxation = iterate.De_is_zero() ? nullptr : iterate.De().data() + first_path_row_;
  const int flag = parts_.solve(iterate.jacobian(), iterate.hessian(),
                                {iterate.Dx().data(), relaxation, weights_, side_.x, rows_reduced_, step.x, step.rows});
  if (flag != LinsolReturnFlag::SUCCESS) return static_cast<LinsolReturnFlag>(flag);
  recover(iterate, side_, step);
  double before = std::numeric_limits<double>::max();
  const Step* found = &step;
  for (int round = 0; round < kRounds; ++round) {
    if (!finite(*found)) return LinsolReturnFlag::NAN_SOLUTION;
    const double now = residual(iterate, *found);
    if (now >= before) return LinsolReturnFlag::ITREF_INCREASE;
    if (found != &step) {
      std::copy_n(found->x, columns_, step.x);
      std::copy_n(found->rows, rows_, step.rows);
      std::copy_n(found->s, slacks_, step.s);
      std::copy_n(found->lower, slacks_, step.lower);
      std::copy_n(found->upper, slacks_, step.upper);
    }
    if (now < tolerance(size_)) return LinsolReturnFlag::SUCCESS;
    if (round + 1 == kRounds) break;
    solve_again(iterate, of(residual_), correction_);
    add(step, correction_, better_);
    found = &better_;
    before = now;
  }
  return LinsolReturnFlag::ITREF_MAX_ITER;
}

void StageStep::accept(Iterate& iterate) {
  // What depends on the step is no longer known.
  iterate.set_delta_primal_s(iterate.delta_primal_s());
}

}  // namespace robotraj::native
