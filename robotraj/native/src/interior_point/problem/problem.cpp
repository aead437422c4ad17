#include "problem.hpp"

#include "newton/sparse_system.hpp"
#include "newton/stage_matrices.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace robotraj::interior_point {

namespace {

using native::Program;

void need(std::size_t have, int want, const char* what) {
  if (have != static_cast<std::size_t>(want))
    throw std::invalid_argument(std::string(what) + " of the stages add up to " + std::to_string(want) +
                                ", but the program has " + std::to_string(have));
}

/// The state that a row of the dynamics gives enters it with -1 alone.
void check_dynamics(const Program& program, const Layout& layout) {
  const native::Pattern& pattern = program.jacobian_pattern();
  std::size_t entry = 0;
  for (std::size_t k = 0; k < layout.count(); ++k)
    for (int i = 0; i < layout.next_states(k); ++i) {
      const int row = layout.first_dynamics[k] + i, column = layout.first_state[k + 1] + i;
      bool alone = program.linear_rows().at(row, column) == -1.0;
      for (; entry < pattern.size() && pattern.rows[entry] <= row; ++entry)
        if (pattern.rows[entry] == row && pattern.columns[entry] == column)
          for (const native::Term& term : program.terms())
            alone = alone && (!term.jacobian.entries() || term.jacobian.empty(entry));
      if (!alone)
        throw std::invalid_argument("row " + std::to_string(row) + " is dynamics, so it has -1 at column " +
                                    std::to_string(column) + " alone, the state it gives");
    }
}

/// Of one stage without states as a sparse matrix, of all others by stages.
std::shared_ptr<native::NewtonMatrices> matrices_of(Program& program, const Layout& layout) {
  need(program.columns(), layout.columns, "controls and states");
  need(program.rows(), layout.rows, "rows");
  const native::Pattern &jacobian = program.jacobian_pattern(), &hessian = program.hessian_pattern();
  std::shared_ptr<native::NewtonMatrices> matrices;
  if (layout.count() == 1 && layout.states[0] == 0)
    matrices = std::make_shared<native::SparseMatrices>(layout, jacobian, hessian, program.elimination_groups());
  else matrices = std::make_shared<native::StageMatrices>(layout, jacobian, hessian);
  check_dynamics(program, layout);
  program.place(std::move(matrices->jacobian_places), std::move(matrices->hessian_places));
  return matrices;
}

}  // namespace

void Problem::bounds_changed() {
  bound_count_ = 0;
  for (const Numbers* bounds : {&lower, &upper})
    bound_count_ += static_cast<int>(
        std::count_if(bounds->begin(), bounds->end(), [](double bound) { return std::isfinite(bound); }));
}

ProgramProblem::ProgramProblem(std::shared_ptr<Program> program, const Layout& layout)
    : Problem(matrices_of(*program, layout)), program_(std::move(program)) {
  lower.resize(layout.slacks);
  upper.resize(layout.slacks);
}

double ProgramProblem::objective(const double* x, const double*) {
  program_->set_point(x);
  return objective_scale * program_->objective();
}

void ProgramProblem::gradient(const double* x, const double*, double* of_x, double* of_s) {
  program_->set_point(x);
  const Numbers& gradient = program_->gradient();
  for (std::size_t i = 0; i < gradient.size(); ++i) of_x[i] = objective_scale * gradient[i];
  std::fill_n(of_s, layout().slacks, 0.0);
}

void ProgramProblem::residual(const double* x, const double* s, double* out) {
  program_->set_point(x);
  const Numbers& values = program_->row_values();
  std::copy(values.begin(), values.end(), out);
  for (int i = 0; i < layout().slacks; ++i) out[layout().inequality_rows + i] -= s[i];
}

void ProgramProblem::add_slack_product(const double* lam, double* out) const {
  for (int i = 0; i < layout().slacks; ++i) out[i] -= lam[layout().inequality_rows + i];
}

void ProgramProblem::jacobian(const double* x, StageValues& values) {
  program_->set_point(x);
  program_->jacobian_to(values.data());
}

void ProgramProblem::hessian(const double* x, const double* lam, bool convex, StageValues& values) {
  program_->set_point(x);
  program_->hessian_to(lam, objective_scale, values.data(), convex);
}

void ProgramProblem::row_hessian(const double* x, const double* lam, bool convex, StageValues& values) {
  program_->set_point(x);
  program_->hessian_to(lam, 0.0, values.data(), convex);
}

}  // namespace robotraj::interior_point
