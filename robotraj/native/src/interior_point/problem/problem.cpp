#include "problem.hpp"

#include "newton/sparse_system.hpp"
#include "newton/stage_matrices.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace robotraj::interior_point {

namespace {

using native::Pattern;
using native::Program;

std::string named(std::size_t row, std::size_t column) {
  return "(" + std::to_string(row) + ", " + std::to_string(column) + ")";
}

void need(std::size_t have, int want, const char* what) {
  if (have != static_cast<std::size_t>(want))
    throw std::invalid_argument(std::string(what) + " of the stages add up to " + std::to_string(want) +
                                ", but the program has " + std::to_string(have));
}

/// Of every row or column, the stage that has it.
std::vector<std::size_t> stages_of_rows(const Layout& layout) {
  std::vector<std::size_t> stages;
  for (std::size_t k = 0; k < layout.count(); ++k)
    stages.insert(stages.end(), static_cast<std::size_t>(layout.next_states(k)), k);
  for (const auto* sizes : {&layout.equalities, &layout.inequalities})
    for (std::size_t k = 0; k < layout.count(); ++k)
      stages.insert(stages.end(), static_cast<std::size_t>((*sizes)[k]), k);
  return stages;
}

std::vector<std::size_t> stages_of_columns(const Layout& layout) {
  std::vector<std::size_t> stages;
  for (std::size_t k = 0; k < layout.count(); ++k)
    stages.insert(stages.end(), static_cast<std::size_t>(layout.unknowns(k)), k);
  return stages;
}

void check_jacobian(const Program& program, const Layout& layout) {
  const auto rows = stages_of_rows(layout), columns = stages_of_columns(layout);
  const auto dynamics = static_cast<std::size_t>(layout.equality_rows);
  const auto next_state = [&](std::size_t row) {
    const std::size_t k = rows[row];
    return static_cast<std::size_t>(layout.first_state[k + 1] - layout.first_dynamics[k]) + row;
  };
  for (std::size_t row = 0; row < dynamics; ++row)
    if (program.linear_rows().at(row, next_state(row)) != -1.0)
      throw std::invalid_argument("row " + std::to_string(row) + " is dynamics, so it has -1 at column " +
                                  std::to_string(next_state(row)) + ", the state it gives");
  const Pattern& pattern = program.jacobian_pattern();
  for (std::size_t entry = 0; entry < pattern.size(); ++entry) {
    const auto row = static_cast<std::size_t>(pattern.rows[entry]);
    const auto column = static_cast<std::size_t>(pattern.columns[entry]);
    if (row < dynamics && column == next_state(row)) {
      for (const native::Term& term : program.terms())
        if (term.jacobian.entries() && !term.jacobian.empty(entry))
          throw std::invalid_argument("Jacobian entry " + named(row, column) +
                                      " depends on a block, but the state a "
                                      "dynamics row gives enters it with -1 alone");
    } else if (columns[column] != rows[row]) {
      throw std::invalid_argument("Jacobian entry " + named(row, column) + " joins stages " +
                                  std::to_string(rows[row]) + " and " + std::to_string(columns[column]));
    }
  }
}

void check_hessian(const Program& program, const Layout& layout) {
  const auto columns = stages_of_columns(layout);
  const Pattern& pattern = program.hessian_pattern();
  for (std::size_t entry = 0; entry < pattern.size(); ++entry) {
    const auto row = static_cast<std::size_t>(pattern.rows[entry]);
    const auto column = static_cast<std::size_t>(pattern.columns[entry]);
    if (columns[row] != columns[column])
      throw std::invalid_argument("Hessian entry " + named(row, column) + " joins stages " +
                                  std::to_string(columns[row]) + " and " + std::to_string(columns[column]));
  }
}

/// Of one stage without states as a sparse matrix, of all others by stages.
std::shared_ptr<native::NewtonMatrices> matrices_of(Program& program, const Layout& layout) {
  need(program.columns(), layout.columns, "controls and states");
  need(program.rows(), layout.rows, "rows");
  check_jacobian(program, layout);
  check_hessian(program, layout);
  const Pattern &jacobian = program.jacobian_pattern(), &hessian = program.hessian_pattern();
  std::shared_ptr<native::NewtonMatrices> matrices;
  if (layout.count() == 1 && layout.states[0] == 0)
    matrices = std::make_shared<native::SparseMatrices>(layout, jacobian, hessian, program.elimination_groups());
  else matrices = std::make_shared<native::StageMatrices>(layout, jacobian, hessian);
  program.place(matrices->jacobian_places(), matrices->hessian_places());
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
  lower.resize(static_cast<std::size_t>(layout.slacks));
  upper.resize(static_cast<std::size_t>(layout.slacks));
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
