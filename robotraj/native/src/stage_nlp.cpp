#include "stage_nlp.hpp"

#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

namespace robotraj::native {

using fatrop::Index;
using fatrop::Scalar;
using Hessian = fatrop::Hessian<fatrop::OcpType>;
using Jacobian = fatrop::Jacobian<fatrop::OcpType>;

namespace {

fatrop::ProblemDims<fatrop::OcpType> to_dims(const Stages& stages) {
  const std::size_t count = stages.states.size();
  if (count == 0) throw std::invalid_argument("a program has at least one stage");
  for (const auto* sizes : {&stages.controls, &stages.equalities, &stages.inequalities})
    if (sizes->size() != count)
      throw std::invalid_argument("controls, states, equalities and inequalities differ in their number of stages");
  for (std::size_t k = 0; k < count; ++k)
    if (stages.equalities[k] > stages.states[k] + stages.controls[k])
      throw std::invalid_argument("stage " + std::to_string(k) + " has more path equalities than unknowns: " +
                                  std::to_string(stages.equalities[k]));
  return {static_cast<int>(count), stages.controls, stages.states, stages.equalities, stages.inequalities};
}

/// Where element (i, j) of a matrix stands, counted from its first number.
std::int32_t place_in(fatrop::MatRealAllocated& matrix, std::size_t i, std::size_t j) {
  MAT& mat = matrix.mat();
  return static_cast<std::int32_t>(&BLASFEO_DMATEL(&mat, static_cast<int>(i), static_cast<int>(j)) - mat.pA);
}

/// Lets writes go through memory in order.
template <typename Slots>
void order(std::vector<Slots>& matrices) {
  for (Slots& slots : matrices)
    std::sort(slots.begin(), slots.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
}

template <typename Matrix, typename Slots>
void fill(Matrix& matrix, const Slots& slots, const Numbers& entries) {
  double* first = matrix.mat().pA;
  for (const auto& slot : slots) first[slot.place] = entries[static_cast<std::size_t>(slot.entry)];
}

void need(std::size_t have, std::size_t want, const char* what) {
  if (have != want)
    throw std::invalid_argument(std::string(what) + " of the stages add up to " + std::to_string(want) +
                                ", but the program has " + std::to_string(have));
}

std::string named(std::size_t row, std::size_t column) {
  return "(" + std::to_string(row) + ", " + std::to_string(column) + ")";
}

}  // namespace

StageNlp::StageNlp(std::shared_ptr<Program> program, const Stages& stages)
    : program_(std::move(program)),
      info_(to_dims(stages)),
      nlp_dims_(info_.number_of_primal_variables, info_.number_of_eq_constraints, info_.number_of_slack_variables),
      n_dynamics_(static_cast<std::size_t>(info_.number_of_g_eq_dyn)),
      n_path_(static_cast<std::size_t>(info_.number_of_g_eq_path)),
      n_slack_(static_cast<std::size_t>(info_.number_of_g_eq_slack)),
      lam_(n_dynamics_ + n_path_ + n_slack_) {
  need(program_->columns(), static_cast<std::size_t>(info_.number_of_primal_variables), "controls and states");
  need(program_->rows(), lam_.size(), "rows");
  start.resize(program_->columns());
  lower.resize(n_slack_);
  upper.resize(n_slack_);
  stage_of_column_.reserve(program_->columns());
  for (std::size_t k = 0; k < stages.states.size(); ++k)
    stage_of_column_.insert(stage_of_column_.end(), static_cast<std::size_t>(stages.controls[k] + stages.states[k]), k);
  const bool dense = !StageParts::take_over();
  place_jacobian(dense);
  place_hessian(dense);
  if (dense) return;
  parts_ = std::make_unique<StageParts>(info_, program_->jacobian_pattern(), program_->hessian_pattern());
  program_->place(parts_->matrices().jacobian_places(), parts_->matrices().hessian_places());
}

std::size_t StageNlp::stage_of(std::size_t column) const { return stage_of_column_[column]; }

void StageNlp::place_jacobian(bool dense) {
  const auto& dims = info_.dims;
  const auto stages = static_cast<std::size_t>(dims.K);
  std::optional<Jacobian> layout;
  if (dense) layout.emplace(dims);
  dynamics_.resize(stages - 1);
  path_.resize(stages);
  slack_.resize(stages);

  // Of every row, in the program's order: its stage, its number there, and which of the three kinds it is.
  struct Place {
    std::size_t stage, index;
    int kind;
  };
  std::vector<Place> places;
  for (std::size_t k = 0; k + 1 < stages; ++k)
    for (Index i = 0; i < dims.number_of_states[k + 1]; ++i) places.push_back({k, static_cast<std::size_t>(i), 0});
  for (std::size_t k = 0; k < stages; ++k)
    for (Index i = 0; i < dims.number_of_eq_constraints[k]; ++i) places.push_back({k, static_cast<std::size_t>(i), 1});
  for (std::size_t k = 0; k < stages; ++k)
    for (Index i = 0; i < dims.number_of_ineq_constraints[k]; ++i)
      places.push_back({k, static_cast<std::size_t>(i), 2});

  const auto next_state = [&](const Place& place) {
    return static_cast<std::size_t>(info_.offsets_primal_x[place.stage + 1]) + place.index;
  };
  for (std::size_t row = 0; row < n_dynamics_; ++row)
    if (program_->linear_rows().at(row, next_state(places[row])) != -1.0)
      throw std::invalid_argument("row " + std::to_string(row) + " is dynamics, so it has -1 at column " +
                                  std::to_string(next_state(places[row])) + ", the state it gives");

  const Pattern& pattern = program_->jacobian_pattern();
  for (std::size_t entry = 0; entry < pattern.size(); ++entry) {
    const auto row = static_cast<std::size_t>(pattern.rows[entry]);
    const auto column = static_cast<std::size_t>(pattern.columns[entry]);
    const Place& place = places[row];
    const std::size_t stage = stage_of(column);
    // fatrop knows the -1 of the next state by itself.
    if (place.kind == 0 && column == next_state(place)) {
      for (const Term& term : program_->terms())
        if (term.jacobian.entries() && !term.jacobian.empty(entry))
          throw std::invalid_argument("Jacobian entry " + named(row, column) + " depends on a block, but the state a "
                                      "dynamics row gives enters it with -1 alone");
      continue;
    }
    if (stage != place.stage)
      throw std::invalid_argument("Jacobian entry " + named(row, column) + " joins stages " +
                                  std::to_string(place.stage) + " and " + std::to_string(stage));
    if (!dense) continue;
    const std::size_t i = column - static_cast<std::size_t>(info_.offsets_primal_u[stage]);
    auto& matrix = (place.kind == 0 ? layout->BAbt : place.kind == 1 ? layout->Gg_eqt : layout->Gg_ineqt)[stage];
    Slots& slots = (place.kind == 0 ? dynamics_ : place.kind == 1 ? path_ : slack_)[stage];
    slots.push_back({place_in(matrix, i, place.index), static_cast<std::int32_t>(entry)});
  }
  order(dynamics_);
  order(path_);
  order(slack_);
}

void StageNlp::place_hessian(bool dense) {
  std::optional<Hessian> layout;
  if (dense) layout.emplace(info_.dims);
  hessian_.resize(static_cast<std::size_t>(info_.dims.K));
  const Pattern& pattern = program_->hessian_pattern();
  for (std::size_t entry = 0; entry < pattern.size(); ++entry) {
    const auto row = static_cast<std::size_t>(pattern.rows[entry]);
    const auto column = static_cast<std::size_t>(pattern.columns[entry]);
    const std::size_t stage = stage_of(row);
    if (stage_of(column) != stage)
      throw std::invalid_argument("Hessian entry " + named(row, column) + " joins stages " + std::to_string(stage) +
                                  " and " + std::to_string(stage_of(column)));
    if (!dense) continue;
    const auto first = static_cast<std::size_t>(info_.offsets_primal_u[stage]);
    auto& matrix = layout->RSQrqt[stage];
    const auto number = static_cast<std::int32_t>(entry);
    // fatrop multiplies by the whole matrix, so both triangles are kept.
    hessian_[stage].push_back({place_in(matrix, row - first, column - first), number});
    if (row != column) hessian_[stage].push_back({place_in(matrix, column - first, row - first), number});
  }
  order(hessian_);
}

void StageNlp::rows_from_fatrop(const double* fatrop, double* program) const {
  std::copy_n(fatrop + info_.offset_g_eq_dyn, n_dynamics_, program);
  std::copy_n(fatrop + info_.offset_g_eq_path, n_path_, program + n_dynamics_);
  std::copy_n(fatrop + info_.offset_g_eq_slack, n_slack_, program + n_dynamics_ + n_path_);
}

void StageNlp::rows_to_fatrop(const double* program, double* fatrop) const {
  std::copy_n(program, n_dynamics_, fatrop + info_.offset_g_eq_dyn);
  std::copy_n(program + n_dynamics_, n_path_, fatrop + info_.offset_g_eq_path);
  std::copy_n(program + n_dynamics_ + n_path_, n_slack_, fatrop + info_.offset_g_eq_slack);
}

Index StageNlp::eval_lag_hess(const Info&, Scalar factor, const Vector& primal_x, const Vector&,
                              const Vector& lam, Hessian& hess) {
  program_->set_point(primal_x.data());
  rows_from_fatrop(lam.data(), lam_.data());
  if (parts_) {
    program_->hessian_to(lam_.data(), factor * objective_scale, parts_->values(hess).data());
    return 0;
  }
  const Numbers& entries = program_->hessian(lam_.data(), factor * objective_scale);
  for (std::size_t k = 0; k < hessian_.size(); ++k) fill(hess.RSQrqt[k], hessian_[k], entries);
  return 0;
}

Index StageNlp::eval_constr_jac(const Info&, const Vector& primal_x, const Vector&, Jacobian& jac) {
  program_->set_point(primal_x.data());
  if (parts_) {
    program_->jacobian_to(parts_->values(jac).data());
    return 0;
  }
  const Numbers& entries = program_->jacobian();
  for (std::size_t k = 0; k < dynamics_.size(); ++k) fill(jac.BAbt[k], dynamics_[k], entries);
  for (std::size_t k = 0; k < path_.size(); ++k) fill(jac.Gg_eqt[k], path_[k], entries);
  for (std::size_t k = 0; k < slack_.size(); ++k) fill(jac.Gg_ineqt[k], slack_[k], entries);
  return 0;
}

Index StageNlp::eval_constraint_violation(const Info&, const Vector& primal_x, const Vector& primal_s, Vector& res) {
  program_->set_point(primal_x.data());
  if (lam_.empty()) return 0;
  double* violation = res.data();
  rows_to_fatrop(program_->row_values().data(), violation);
  double* slack_rows = violation + info_.offset_g_eq_slack;
  const double* slacks = primal_s.data();
  for (std::size_t i = 0; i < n_slack_; ++i) slack_rows[i] -= slacks[i];
  return 0;
}

Index StageNlp::eval_objective_gradient(const Info&, Scalar factor, const Vector& primal_x, const Vector&,
                                        Vector& grad_x, Vector& grad_s) {
  program_->set_point(primal_x.data());
  const Numbers& gradient = program_->gradient();
  double* out = grad_x.data();
  const double scale = factor * objective_scale;
  for (std::size_t i = 0; i < gradient.size(); ++i) out[i] = scale * gradient[i];
  if (n_slack_) std::fill_n(grad_s.data(), n_slack_, 0.0);
  return 0;
}

Index StageNlp::eval_objective(const Info&, Scalar factor, const Vector& primal_x, const Vector&,
                               Scalar& res) {
  program_->set_point(primal_x.data());
  res = factor * objective_scale * program_->objective();
  return 0;
}

Index StageNlp::get_bounds(const Info&, Vector& lower_bounds, Vector& upper_bounds) {
  if (n_slack_ == 0) return 0;
  std::copy(lower.begin(), lower.end(), lower_bounds.data());
  std::copy(upper.begin(), upper.end(), upper_bounds.data());
  return 0;
}

Index StageNlp::get_initial_primal(const Info&, Vector& primal_x) {
  std::copy(start.begin(), start.end(), primal_x.data());
  return 0;
}

void StageNlp::get_primal_damping(const Info&, Vector& damping) { damping = 0; }

void StageNlp::apply_jacobian_s_transpose(const Info&, const Vector& multipliers, Scalar alpha, const Vector& y,
                                          Vector& out) {
  // The rows are c(x) - s, so their derivative in s is -1.
  out = alpha * y;
  if (n_slack_ == 0) return;
  const double* lam = multipliers.data() + info_.offset_g_eq_slack;
  double* result = out.data();
  for (std::size_t i = 0; i < n_slack_; ++i) result[i] -= lam[i];
}

}  // namespace robotraj::native
