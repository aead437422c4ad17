#include "stage_step.hpp"

#include <algorithm>
#include <cmath>

namespace robotraj::native {

namespace {

constexpr int kRounds = 5;

/// Residual that is small enough beside a right-hand side of size b.
double tolerance(double b) { return std::max(1e-8, (b < 1.0 ? 1e-7 : 1e-6) * b); }

/// fatrop gives its vectors for reading alone; the step's are written here.
double* writable(const fatrop::VecRealView& vector) { return const_cast<double*>(vector.data()); }

}  // namespace

StageStep::StageStep(StageParts& parts) : parts_(parts), run_(parts.vectors()), stages_(parts.matrices().count()) {
  const StageMatrices::Info& info = parts.info();
  columns_ = info.number_of_primal_variables;
  rows_ = info.number_of_eq_constraints;
  slacks_ = info.number_of_slack_variables;
  first_slack_row_ = info.offset_g_eq_slack;
  first_path_row_ = info.offset_g_eq_path;
  memory_.resize(4 * static_cast<std::size_t>(padded(slacks_)));
  double* at = memory_.data();
  for (double** each : {&inverse_, &gradient_, &weights_, &slack_rows_}) {
    *each = at;
    at += padded(slacks_);
  }
  make_part();
}

/// Room for as many stages as are looked at together.
void StageStep::make_part() {
  const auto& dims = parts_.info().dims;
  int columns = 0, dynamics = 0, equalities = 0, inequalities = 0;
  for (std::size_t begin = 0; begin < stages_; begin += at_a_time) {
    int here[4] = {};
    for (std::size_t k = begin; k < std::min(begin + at_a_time, stages_); ++k) {
      here[0] += dims.number_of_controls[k] + dims.number_of_states[k];
      here[1] += k + 1 < stages_ ? dims.number_of_states[k + 1] : 0;
      here[2] += dims.number_of_eq_constraints[k];
      here[3] += dims.number_of_ineq_constraints[k];
    }
    columns = std::max(columns, here[0]);
    dynamics = std::max(dynamics, here[1]);
    equalities = std::max(equalities, here[2]);
    inequalities = std::max(inequalities, here[3]);
  }
  part_memory_.resize(static_cast<std::size_t>(padded(columns) + padded(dynamics) + padded(equalities) +
                                               4 * padded(inequalities)));
  double* at = part_memory_.data();
  const auto part = [&at](int n) {
    double* here = at;
    at += padded(n);
    return here;
  };
  part_ = {{part(columns), part(dynamics), part(equalities), part(inequalities)},
           {part(inequalities), part(inequalities), part(inequalities)}};
}

void StageStep::make_refinement() {
  if (!refinement_memory_.empty()) return;
  refinement_memory_.resize(3 * static_cast<std::size_t>(padded(columns_) + padded(rows_) + 3 * padded(slacks_)));
  double* at = refinement_memory_.data();
  for (Step* each : {&residual_, &correction_, &better_}) *each = take(at);
}

StageStep::Step StageStep::take(double*& at) const {
  const auto part = [&at](int n) {
    double* here = at;
    at += padded(n);
    return here;
  };
  return {part(columns_), part(rows_), part(slacks_), part(slacks_), part(slacks_)};
}

StageStep::Left StageStep::whole(const Step& step) const {
  return {{step.x, step.rows + parts_.info().offset_g_eq_dyn, step.rows + first_path_row_, step.rows + first_slack_row_},
          {step.s, step.lower, step.upper}};
}

int StageStep::first_slack(std::size_t stage) const {
  return stage < stages_ ? parts_.info().offsets_slack[stage] : slacks_;
}

RiccatiSolver::System StageStep::system(Iterate& iterate, const Side& side, const double* weights,
                                        const Step& step) const {
  const double* relaxation = iterate.De_is_zero() ? nullptr : iterate.De().data() + first_path_row_;
  // Where slacks are eliminated, rows of inequalities are no longer the side's.
  return {iterate.Dx().data(), relaxation, weights, side.x, side.rows,
          weights ? slack_rows_ : side.rows + first_slack_row_, step.x, step.rows};
}

SlackSystem StageStep::slacks(const Iterate& iterate, int first) const {
  Iterate& known = const_cast<Iterate&>(iterate);  // evaluated already
  return {known.delta_lower().data() + first,     known.delta_upper().data() + first,
          iterate.dual_bounds_l().data() + first, iterate.dual_bounds_u().data() + first,
          iterate.Dx().data() + columns_ + first, iterate.De().data() + first_slack_row_ + first};
}

void StageStep::prepare(Iterate& iterate) {
  side_ = {iterate.dual_infeasibility_x().data(), iterate.constr_viol().data(), iterate.dual_infeasibility_s().data(),
           iterate.relaxed_complementarity_l().data(), iterate.relaxed_complementarity_u().data()};
  size_ = std::max({iterate.dual_infeasibility_x_inf(), iterate.constr_viol_inf(),
                    iterate.dual_infeasibility_s_inf(), run_.largest(side_.lower, slacks_),
                    run_.largest(side_.upper, slacks_)});
}

void StageStep::reduce(const Iterate& iterate, const Side& side, std::size_t begin, std::size_t end) {
  const int first = first_slack(begin);
  run_.reduce(slacks(iterate, first),
              {side.s + first, side.lower + first, side.upper + first, side.rows + first_slack_row_ + first},
              first_slack(end) - first, inverse_ + first, gradient_ + first, weights_ + first, slack_rows_ + first);
}

void StageStep::recover(const Iterate& iterate, const Side& side, const Step& step, std::size_t begin,
                        std::size_t end) const {
  const int first = first_slack(begin);
  run_.recover(slacks(iterate, first), {side.s + first, side.lower + first, side.upper + first, nullptr},
               inverse_ + first, gradient_ + first, step.rows + first_slack_row_ + first, first_slack(end) - first,
               {step.s + first, step.lower + first, step.upper + first});
}

double StageStep::residual(Iterate& iterate, const Step& step, std::size_t begin, std::size_t end, const Left& left) {
  const int first = first_slack(begin), count = first_slack(end) - first;
  const double of_stages = parts_.residual(iterate.jacobian(), iterate.hessian(), system(iterate, side_, nullptr, step),
                                           begin, end, left.stages);
  const double of_slacks = run_.slack_residual(
      slacks(iterate, first), {side_.s + first, side_.lower + first, side_.upper + first, nullptr},
      {step.s + first, step.lower + first, step.upper + first}, step.rows + first_slack_row_ + first, count,
      left.slacks, left.stages.inequalities);
  return std::max({of_stages, of_slacks, run_.largest(left.stages.inequalities, count)});
}

void StageStep::after(std::size_t begin, std::size_t end) {
  recover(*solved_, side_, step_, begin, end);
  left_ = std::max(left_, residual(*solved_, step_, begin, end, part_));
}

void StageStep::solve_again(Iterate& iterate, const Side& side, const Step& step) {
  reduce(iterate, side, 0, stages_);
  parts_.solve_again(iterate.jacobian(), system(iterate, side, weights_, step));
  recover(iterate, side, step, 0, stages_);
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
  solved_ = &iterate;
  step_ = {writable(iterate.delta_primal_x()), writable(iterate.delta_dual_eq()), writable(iterate.delta_primal_s()),
           writable(iterate.delta_dual_bounds_l()), writable(iterate.delta_dual_bounds_u())};
  left_ = 0.0;
  const int flag = parts_.solve(iterate.jacobian(), iterate.hessian(), system(iterate, side_, weights_, step_), this);
  if (flag != LinsolReturnFlag::SUCCESS) return static_cast<LinsolReturnFlag>(flag);
  if (!finite(step_)) return LinsolReturnFlag::NAN_SOLUTION;
  return left_ < tolerance(size_) ? LinsolReturnFlag::SUCCESS : refine(iterate);
}

fatrop::LinsolReturnFlag StageStep::refine(Iterate& iterate) {
  using fatrop::LinsolReturnFlag;
  make_refinement();
  const Left left = whole(residual_);
  residual(iterate, step_, 0, stages_, left);
  for (int round = 1; left_ >= tolerance(size_); ++round) {
    if (round == kRounds) return LinsolReturnFlag::ITREF_MAX_ITER;
    solve_again(iterate, of(residual_), correction_);
    add(step_, correction_, better_);
    if (!finite(better_)) return LinsolReturnFlag::NAN_SOLUTION;
    const double now = residual(iterate, better_, 0, stages_, left);
    if (now >= left_) return LinsolReturnFlag::ITREF_INCREASE;
    left_ = now;
    std::copy_n(better_.x, columns_, step_.x);
    std::copy_n(better_.rows, rows_, step_.rows);
    std::copy_n(better_.s, slacks_, step_.s);
    std::copy_n(better_.lower, slacks_, step_.lower);
    std::copy_n(better_.upper, slacks_, step_.upper);
  }
  return LinsolReturnFlag::SUCCESS;
}

void StageStep::accept(Iterate& iterate) {
  // What depends on the step is no longer known.
  iterate.set_delta_primal_s(iterate.delta_primal_s());
}

}  // namespace robotraj::native
