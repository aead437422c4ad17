#include "newton.hpp"

#include <algorithm>
#include <cmath>

namespace robotraj::interior_point {

using native::padded;
using native::Pivots;
using native::SlackSystem;

namespace {

constexpr int kRounds = 5;

/// Largest accepted residual for a right-hand side of size b.
double tolerance(double b) { return std::max(1e-8, 1e-5 * b); }

Side side_of(const Vectors& step) { return {step.x, step.rows, step.s, step.lower, step.upper}; }

}  // namespace

Newton::Newton(Problem& problem)
    : problem_(problem),
      run_(native::vector_kernels_of()),
      solver_(problem.matrices().solver()),
      hessian_(problem.matrices().empty_hessian()),
      own_slacks_(problem.layout().slacks),
      relaxed_(problem.rows() - problem.layout().equality_rows),
      size_of_step_(Room::size(problem)),
      memory_(static_cast<std::size_t>(4 * padded(own_slacks_) + padded(problem.columns()) + padded(problem.slacks()) +
                                       padded(relaxed_))) {
  Parts parts(memory_);
  for (double** each : {&inverse_, &gradient_, &weights_, &slack_rows_}) *each = parts.take(own_slacks_);
  damping_x_ = parts.take(problem.columns());
  damping_s_ = parts.take(problem.slacks());
  relaxation_ = parts.take(relaxed_);
  if (problem.elastic()) {
    elastic_memory_.resize(static_cast<std::size_t>(5 * padded(relaxed_) + padded(problem.rows())));
    Parts more(elastic_memory_);
    elastic_inverse_ = more.take(2 * relaxed_);
    elastic_slope_ = more.take(2 * relaxed_);
    elastic_relaxation_ = more.take(relaxed_);
    elastic_rows_ = more.take(problem.rows());
  }
  make_part();
}

/// Allocates the residuals of as many stages as are processed together.
void Newton::make_part() {
  const Layout& layout = problem_.layout();
  int largest[4] = {};
  for (std::size_t k = 0; k < layout.count(); ++k) {
    const int sizes[] = {layout.unknowns(k), layout.next_states(k), layout.equalities[k], layout.inequalities[k]};
    for (int i = 0; i < 4; ++i) largest[i] = std::max(largest[i], sizes[i]);
  }
  const int stages = static_cast<int>(std::min(at_a_time, layout.count()));
  const int columns = stages * largest[0], dynamics = stages * largest[1], equalities = stages * largest[2],
            inequalities = stages * largest[3];
  part_memory_.resize(
      static_cast<std::size_t>(padded(columns) + padded(dynamics) + padded(equalities) + 4 * padded(inequalities)));
  Parts parts(part_memory_);
  part_.stages = {parts.take(columns), parts.take(dynamics), parts.take(equalities), parts.take(inequalities)};
  part_.slacks = {parts.take(inequalities), parts.take(inequalities), parts.take(inequalities)};
}

void Newton::set_damping(double delta_w, double delta_c) {
  const double* more = problem_.damping();
  if (delta_w != delta_w_ || more) {
    std::fill_n(damping_x_, problem_.columns(), delta_w);
    std::fill_n(damping_s_, problem_.slacks(), delta_w);
    if (more) run_.add(damping_x_, more, problem_.columns(), damping_x_);
  }
  if (delta_c != delta_c_) std::fill_n(relaxation_, relaxed_, delta_c);
  delta_w_ = delta_w;
  delta_c_ = delta_c;
  relaxes_ = delta_c > 0.0 || problem_.elastic();
}

Newton::Left Newton::whole(const Vectors& step) const {
  const Layout& layout = problem_.layout();
  return {{step.x, step.rows, step.rows + layout.equality_rows, step.rows + layout.inequality_rows},
          {step.s, step.lower, step.upper}};
}

int Newton::first_slack(std::size_t stage) const {
  return stage < problem_.layout().count() ? problem_.layout().first_slack[stage] : own_slacks_;
}

native::NewtonSystem Newton::system(const Side& side, bool reduced, const Vectors& step) const {
  // The elimination of slacks changes the right-hand side of the rows.
  const bool elastic = reduced && problem_.elastic();
  const double* rows = elastic ? elastic_rows_ : side.rows;
  const double* relaxation = elastic ? elastic_relaxation_ : relaxation_;
  return {damping_x_,
          relaxes_ ? relaxation : nullptr,
          reduced ? weights_ : nullptr,
          side.x,
          rows,
          reduced ? slack_rows_ : rows + problem_.layout().inequality_rows,
          step.x,
          step.rows};
}

SlackSystem Newton::slacks(int first, const double* relaxation) const {
  const int path = problem_.layout().inequality_rows - problem_.layout().equality_rows;
  return {below_ + first,       above_ + first,     lower_duals_ + first,
          upper_duals_ + first, damping_s_ + first, relaxation + path + first};
}

void Newton::reduce(const Side& side, std::size_t begin, std::size_t end) {
  const int first = first_slack(begin);
  const bool elastic = problem_.elastic();
  const double* rows = (elastic ? elastic_rows_ : side.rows) + problem_.layout().inequality_rows;
  run_.reduce(slacks(first, elastic ? elastic_relaxation_ : relaxation_),
              {side.s + first, side.lower + first, side.upper + first, rows + first}, first_slack(end) - first,
              inverse_ + first, gradient_ + first, weights_ + first, slack_rows_ + first);
}

void Newton::recover(const Side& side, const Vectors& step, std::size_t begin, std::size_t end) {
  const int first = first_slack(begin);
  run_.recover(slacks(first, relaxation_), {side.s + first, side.lower + first, side.upper + first, nullptr},
               inverse_ + first, gradient_ + first, step.rows + problem_.layout().inequality_rows + first,
               first_slack(end) - first, {step.s + first, step.lower + first, step.upper + first});
}

double Newton::residual(const Side& side, const Vectors& step, std::size_t begin, std::size_t end, const Left& left) {
  const int first = first_slack(begin), count = first_slack(end) - first;
  const double of_stages = solver_->residual(*jacobian_, hessian_, system(side, false, step), begin, end, left.stages);
  const double of_slacks = run_.slack_residual(
      slacks(first, relaxation_), {side.s + first, side.lower + first, side.upper + first, nullptr},
      {step.s + first, step.lower + first, step.upper + first}, step.rows + problem_.layout().inequality_rows + first,
      count, left.slacks, left.stages.inequalities);
  if (problem_.elastic()) {
    // Rows without p and n are no residuals.
    const double of_dynamics = std::max(run_.largest(left.stages.gradient, problem_.columns()),
                                        run_.largest(left.stages.dynamics, problem_.layout().equality_rows));
    return std::max({of_dynamics, of_slacks, elastic_residual(side, step, left)});
  }
  return std::max({of_stages, of_slacks, run_.largest(left.stages.inequalities, count)});
}

void Newton::after(std::size_t begin, std::size_t end) {
  recover(side_, step_, begin, end);
  left_ = std::max(left_, residual(side_, step_, begin, end, part_));
}

double Newton::size_of(const Side& side) const {
  return std::max({run_.largest(side.x, problem_.columns()), run_.largest(side.rows, problem_.rows()),
                   run_.largest(side.s, problem_.slacks()), run_.largest(side.lower, problem_.slacks()),
                   run_.largest(side.upper, problem_.slacks())});
}

void Newton::take(Iterate& iterate, const Side& side, const Vectors& step) {
  jacobian_ = &iterate.jacobian();
  below_ = iterate.below();
  above_ = iterate.above();
  lower_duals_ = iterate.at->lower;
  upper_duals_ = iterate.at->upper;
  side_ = side;
  step_ = step;
  left_ = 0.0;
  size_ = size_of(side);
}

Solved Newton::solve(Iterate& iterate, const Side& side, double delta_w, double delta_c, const Vectors& step) {
  take(iterate, side, step);
  set_damping(delta_w, delta_c);
  return factorise();
}

Solved Newton::least_squares(Iterate& iterate, const Side& side, double delta_c, const Vectors& step) {
  take(iterate, side, step);
  set_damping(1.0, delta_c);
  std::fill(hessian_.begin(), hessian_.end(), 0.0);
  const Numbers none(static_cast<std::size_t>(problem_.slacks()), 0.0);
  lower_duals_ = upper_duals_ = none.data();
  return factorise();
}

Solved Newton::factorise() {
  const std::size_t stages = problem_.layout().count();
  // The residual of a program without stages is computed once, by `refine`.
  const bool elastic = problem_.elastic(), whole = elastic || stages == 1;
  if (elastic) reduce_elastic(side_);
  if (whole) reduce(side_, 0, stages);
  const auto system = this->system(side_, true, step_);
  solver_->options = options;
  switch (solver_->factorise_and_solve(*jacobian_, hessian_, system, whole ? nullptr : this)) {
    case Pivots::indefinite: return Solved::indefinite;
    case Pivots::dependent: return Solved::dependent;
    default: break;
  }
  if (whole) recover(side_, step_, 0, stages);
  if (elastic) recover_elastic(side_, step_);
  if (!finite(step_)) return Solved::invalid;
  return !whole && left_ < tolerance(size_) ? Solved::good : refine();
}

void Newton::solve_reduced(const Side& side, const Vectors& step) {
  if (problem_.elastic()) reduce_elastic(side);
  reduce(side, 0, problem_.layout().count());
  solver_->solve(*jacobian_, system(side, true, step));
  recover(side, step, 0, problem_.layout().count());
  if (problem_.elastic()) recover_elastic(side, step);
}

Solved Newton::solve_again(Iterate& iterate, const Side& side, const Vectors& step) {
  take(iterate, side, step);
  solve_reduced(side, step);
  return finite(step) ? refine() : Solved::invalid;
}

Solved Newton::refine() {
  if (!residual_)
    for (auto* each : {&residual_, &correction_, &better_}) *each = std::make_unique<Room>(problem_);
  const std::size_t stages = problem_.layout().count();
  const Left left = whole(residual_->get());
  left_ = residual(side_, step_, 0, stages, left);
  const Vectors &more = correction_->get(), &better = better_->get();
  for (int round = 1; left_ >= tolerance(size_); ++round) {
    if (round == kRounds) return Solved::inaccurate;
    solve_reduced(side_of(residual_->get()), more);
    run_.add(step_.x, more.x, size_of_step_, better.x);
    if (!finite(better)) return Solved::invalid;
    const double now = residual(side_, better, 0, stages, left);
    if (now >= left_) return Solved::inaccurate;
    left_ = now;
    std::copy_n(better.x, size_of_step_, step_.x);
  }
  return Solved::good;
}

}  // namespace robotraj::interior_point
