#include "iterate.hpp"

#include <algorithm>

namespace robotraj::interior_point {

using native::padded;

Room::Room(const Problem& problem) : memory_(size(problem)) {
  Parts parts(memory_);
  vectors_.x = parts.take(problem.columns());
  vectors_.rows = parts.take(problem.rows());
  for (double** each : {&vectors_.s, &vectors_.lower, &vectors_.upper}) *each = parts.take(problem.slacks());
}

int Room::size(const Problem& problem) {
  return padded(problem.columns()) + padded(problem.rows()) + 3 * padded(problem.slacks());
}

Iterate::Iterate(Problem& problem)
    : at(problem),
      problem_(problem),
      run_(native::vector_kernels_of()),
      memory_(padded(problem.rows()) + 2 * padded(problem.columns()) + 4 * padded(problem.slacks())),
      jacobian_(problem.matrices().empty_jacobian()) {
  Parts parts(memory_);
  residual_ = parts.take(problem.rows());
  for (double** each : {&gradient_x_, &infeasibility_x_}) *each = parts.take(problem.columns());
  for (double** each : {&below_, &above_, &gradient_s_, &infeasibility_s_}) *each = parts.take(problem.slacks());
}

void Iterate::copy(const Iterate& other) {
  at.copy(other.at);
  known_ = other.known_;
  memory_ = other.memory_;
  if (known_.jacobian) jacobian_ = other.jacobian_;
  objective_ = other.objective_;
  violation_ = other.violation_;
  largest_violation_ = other.largest_violation_;
  logarithms_ = other.logarithms_;
  single_ = other.single_;
  largest_infeasibility_ = other.largest_infeasibility_;
}

double Iterate::objective() {
  if (!known_.objective) objective_ = problem_.objective(at->x, at->s);
  known_.objective = true;
  return objective_;
}

const double* Iterate::residual() {
  if (known_.residual) return residual_;
  problem_.residual(at->x, at->s, residual_);
  violation_ = run_.absolute_sum(residual_, problem_.rows());
  largest_violation_ = run_.largest(residual_, problem_.rows());
  known_.residual = true;
  return residual_;
}

double Iterate::violation() {
  residual();
  return violation_;
}

double Iterate::largest_violation() {
  residual();
  return largest_violation_;
}

void Iterate::measure_distances() {
  if (known_.distances) return;
  const auto sums = run_.distances(problem_.bounds(), at->s, below_, above_);
  logarithms_ = native::log_sum(sums, problem_.bounds(), below_, above_);
  single_ = sums.single;
  known_.distances = true;
}

const double* Iterate::below() {
  measure_distances();
  return below_;
}

const double* Iterate::above() {
  measure_distances();
  return above_;
}

double Iterate::barrier(double mu) {
  measure_distances();
  return objective() + mu * (kappa_d * single_ - logarithms_);
}

void Iterate::differentiate() {
  if (known_.gradient) return;
  problem_.gradient(at->x, at->s, gradient_x_, gradient_s_);
  known_.gradient = true;
}

const double* Iterate::gradient_x() {
  differentiate();
  return gradient_x_;
}

const double* Iterate::gradient_s() {
  differentiate();
  return gradient_s_;
}

const StageValues& Iterate::jacobian() {
  if (!known_.jacobian) problem_.jacobian(at->x, jacobian_);
  known_.jacobian = true;
  return jacobian_;
}

void Iterate::differentiate_lagrangian() {
  if (known_.infeasibility) return;
  differentiate();
  problem_.matrices().transposed_times(jacobian(), at->rows, gradient_x_, infeasibility_x_);
  for (int i = 0; i < problem_.slacks(); ++i) infeasibility_s_[i] = gradient_s_[i] - at->lower[i] + at->upper[i];
  problem_.add_slack_product(at->rows, infeasibility_s_);
  largest_infeasibility_ =
      std::max(run_.largest(infeasibility_x_, problem_.columns()), run_.largest(infeasibility_s_, problem_.slacks()));
  known_.infeasibility = true;
}

const double* Iterate::infeasibility_x() {
  differentiate_lagrangian();
  return infeasibility_x_;
}

const double* Iterate::infeasibility_s() {
  differentiate_lagrangian();
  return infeasibility_s_;
}

double Iterate::largest_infeasibility() {
  differentiate_lagrangian();
  return largest_infeasibility_;
}

}  // namespace robotraj::interior_point
