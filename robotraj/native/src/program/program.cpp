#include "program.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace robotraj::native {

namespace {

void need(std::size_t have, std::size_t want, const std::string& what) {
  if (have != want)
    throw std::invalid_argument(what + " is " + std::to_string(have) + ", expected " + std::to_string(want));
}

template <typename Matrix>
void need_shape(const Matrix& matrix, std::size_t rows, std::size_t columns, const std::string& what) {
  need(matrix.rows(), rows, what + ": number of rows");
  need(matrix.columns(), columns, what + ": number of columns");
}

void need_inside(const Pattern& pattern, std::size_t rows, std::size_t columns, const std::string& what) {
  need(pattern.columns.size(), pattern.rows.size(), what + ": number of column indices");
  for (std::size_t i = 0; i < pattern.size(); ++i)
    if (pattern.rows[i] < 0 || static_cast<std::size_t>(pattern.rows[i]) >= rows || pattern.columns[i] < 0 ||
        static_cast<std::size_t>(pattern.columns[i]) >= columns)
      throw std::invalid_argument(what + ": entry (" + std::to_string(pattern.rows[i]) + ", " +
                                  std::to_string(pattern.columns[i]) + ") lies outside");
}

/// Numbers of an array that has these places.
std::size_t room(const std::vector<std::int32_t>& places) {
  return places.empty() ? 0 : static_cast<std::size_t>(*std::max_element(places.begin(), places.end()) + 1);
}

}  // namespace

Program::Program(LinearPart linear, Pattern jacobian, Pattern hessian, std::vector<Term> terms, std::size_t threads,
                 std::vector<int> groups)
    : linear_(std::move(linear)),
      jacobian_pattern_(std::move(jacobian)),
      hessian_pattern_(std::move(hessian)),
      elimination_groups_(std::move(groups)),
      terms_(std::move(terms)),
      work_(terms_.size()),
      linear_combination_(linear_.rows),
      pool_(std::max<std::size_t>(1, threads)),
      point_(columns()),
      rows_(rows()),
      gradient_(columns()) {
  need_shape(linear_.rows, rows(), columns(), "linear part of the rows");
  need(linear_.jacobian.size(), jacobian_pattern_.size(), "constant Jacobian entries: their number");
  need_inside(jacobian_pattern_, rows(), columns(), "Jacobian");
  need_inside(hessian_pattern_, columns(), columns(), "Hessian");
  if (const std::size_t each = columns() + rows(); elimination_groups_.size() % std::max<std::size_t>(1, each) != 0)
    need(elimination_groups_.size(), each, "groups: length");
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    check(i);
    Term& term = terms_[i];
    Work& work = work_[i];
    const PointSizes& sizes = term.block->sizes();
    work.gather = Combination(term.gather);
    work.scatter = Combination::adding(Stacked(term.scatter));
    work.scatter_transposed = Combination(term.scatter.transposed());
    work.to_gradient = Combination::adding(Stacked(term.gradient));
    work.has_rows = term.scatter.entries() > 0;
    work.has_cost = !term.weights.empty();
    work.v.resize(sizes.inputs * sizes.count);
    work.y.resize(sizes.outputs * sizes.count);
    work.cost.resize(work.has_cost ? sizes.count : 0);
    work.gradient.resize(work.has_cost ? work.v.size() : 0);
    work.jacobian.resize(sizes.jacobian * sizes.count);
    work.m.resize(work.y.size());
    work.hessian.resize(sizes.hessian * sizes.count);
    term.block->prepare(pool_.size());
  }
}

void Program::check(std::size_t index) const {
  const std::string block = "block " + std::to_string(index) + ", ";
  const Term& term = terms_[index];
  const PointSizes& sizes = term.block->sizes();
  const std::size_t inputs = sizes.inputs * sizes.count, outputs = sizes.outputs * sizes.count;
  need_shape(term.gather, inputs, columns(), block + "gather");
  need(term.gather_offset.size(), inputs, block + "gather offset: length");
  need(term.constants.size(), sizes.constants * sizes.count, block + "constants: length");
  if (term.scatter.entries()) need_shape(term.scatter, rows(), outputs, block + "scatter");
  if (!term.weights.empty()) {
    need(term.weights.size(), sizes.count, block + "weights: length");
    if (sizes.costed < 0) throw std::invalid_argument(block + "weights, but none of its outputs carries cost");
    need_shape(term.gradient, columns(), inputs, block + "gradient");
  }
  if (term.jacobian.entries())
    need_shape(term.jacobian, jacobian_pattern_.size(), sizes.jacobian * sizes.count, block + "jacobian");
  if (term.hessian.entries())
    need_shape(term.hessian, hessian_pattern_.size(), sizes.hessian * sizes.count, block + "hessian");
}

template <typename Evaluate>
void Program::timed(double& seconds, Evaluate&& evaluate) {
  const auto began = std::chrono::steady_clock::now();
  evaluate();
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

void Program::forget() {
  point_known_ = rows_known_ = objective_known_ = gradient_known_ = false;
  for (Work& work : work_) work.y_known = false;
}

void Program::set_point(const double* y) {
  if (point_known_ && std::memcmp(y, point_.data(), columns() * sizeof(double)) == 0) return;
  forget();
  std::copy_n(y, columns(), point_.data());
  timed(times.combinations, [&] {
    for (std::size_t i = 0; i < terms_.size(); ++i)
      work_[i].gather.apply(y, terms_[i].gather_offset.data(), work_[i].v.data(), pool_);
  });
  point_known_ = true;
}

const Numbers& Program::values(std::size_t index) {
  Work& work = work_[index];
  if (!work.y_known) {
    evaluate(index, Evaluation::values, work.y);
    work.y_known = true;
  }
  return work.y;
}

void Program::evaluate(std::size_t index, Evaluation which, Numbers& out) {
  const Term& term = terms_[index];
  const Work& work = work_[index];
  const double* m = which >= Evaluation::hessian ? work.m.data() : nullptr;
  timed(times.functions,
        [&] { term.block->evaluate(which, work.v.data(), term.constants.data(), m, out.data(), pool_); });
}

const Numbers& Program::row_values() {
  if (rows_known_) return rows_;
  timed(times.combinations,
        [&] { linear_combination_.apply(point_.data(), linear_.offset.data(), rows_.data(), pool_); });
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (!work_[i].has_rows) continue;
    const Numbers& y = values(i);
    timed(times.combinations, [&] { work_[i].scatter.apply(y.data(), rows_.data(), rows_.data(), pool_); });
  }
  rows_known_ = true;
  return rows_;
}

double Program::objective() {
  if (objective_known_) return objective_;
  double sum = linear_.cost_offset;
  for (std::size_t i = 0; i < columns(); ++i) sum += linear_.cost[i] * point_[i];
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    Work& work = work_[i];
    if (!work.has_cost) continue;
    const Term& term = terms_[i];
    const PointSizes& sizes = term.block->sizes();
    // The values of a block that has rows hold its cost already.
    if (work.has_rows) {
      const double* costed = values(i).data() + sizes.costed;
      for (std::size_t e = 0; e < sizes.count; ++e) sum += term.weights[e] * costed[e * sizes.outputs];
    } else {
      evaluate(i, Evaluation::cost, work.cost);
      for (std::size_t e = 0; e < sizes.count; ++e) sum += term.weights[e] * work.cost[e];
    }
  }
  objective_known_ = true;
  return objective_ = sum;
}

const Numbers& Program::gradient() {
  if (gradient_known_) return gradient_;
  gradient_ = linear_.cost;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    Work& work = work_[i];
    if (!work.has_cost) continue;
    evaluate(i, Evaluation::gradient, work.gradient);
    timed(times.combinations,
          [&] { work.to_gradient.apply(work.gradient.data(), gradient_.data(), gradient_.data(), pool_); });
  }
  gradient_known_ = true;
  return gradient_;
}

void Program::place(std::vector<std::int32_t> jacobian, std::vector<std::int32_t> hessian) {
  need(jacobian.size(), jacobian_pattern_.size(), "places of the Jacobian's entries: their number");
  need(hessian.size(), hessian_pattern_.size(), "places of the Hessian's entries: their number");
  // The first term writes, the others add to it.
  bool written[2] = {false, false};
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Term& term = terms_[i];
    if (term.jacobian.entries()) {
      work_[i].to_jacobian = written[0] ? Combination::adding(Stacked(term.jacobian), jacobian.data())
                                        : Combination(term.jacobian, jacobian.data(), linear_.jacobian.data());
      written[0] = true;
    }
    if (term.hessian.entries()) {
      work_[i].to_hessian =
          written[1] ? Combination::adding(term.hessian, hessian.data()) : Combination(term.hessian, hessian.data());
      written[1] = true;
    }
  }
  jacobian_places_ = std::move(jacobian);
  hessian_places_ = std::move(hessian);
}

Numbers Program::jacobian() {
  Numbers placed(room(jacobian_places_)), entries = linear_.jacobian;
  jacobian_to(placed.data());
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (jacobian_places_[e] >= 0) entries[e] = placed[jacobian_places_[e]];
  return entries;
}

Numbers Program::hessian(const double* lam, double lam_f) {
  Numbers placed(room(hessian_places_)), entries;
  hessian_to(lam, lam_f, placed.data());
  for (const std::int32_t place : hessian_places_) entries.push_back(placed[place]);
  return entries;
}

bool Program::saturates() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const Term& term) { return term.block->saturates(); });
}

void Program::jacobian_to(double* out) {
  const double* sum = nullptr;  // the first term's combination keeps the linear part
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (!terms_[i].jacobian.entries()) continue;
    Work& work = work_[i];
    evaluate(i, Evaluation::jacobian, work.jacobian);
    timed(times.combinations, [&] { work.to_jacobian.apply(work.jacobian.data(), sum, out, pool_); });
    sum = out;
  }
  if (sum) return;
  for (std::size_t e = 0; e < jacobian_places_.size(); ++e)
    if (jacobian_places_[e] >= 0) out[jacobian_places_[e]] = linear_.jacobian[e];
}

void Program::hessian_to(const double* lam, double lam_f, double* out, bool convex) {
  const double* sum = nullptr;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Term& term = terms_[i];
    if (!term.hessian.entries()) continue;
    Work& work = work_[i];
    const PointSizes& sizes = term.block->sizes();
    timed(times.combinations, [&] {
      if (work.has_rows) work.scatter_transposed.apply(lam, nullptr, work.m.data(), pool_);
      else std::fill(work.m.begin(), work.m.end(), 0.0);
    });
    if (work.has_cost)
      for (std::size_t e = 0; e < sizes.count; ++e) work.m[e * sizes.outputs + sizes.costed] += lam_f * term.weights[e];
    evaluate(i, convex ? Evaluation::convex_hessian : Evaluation::hessian, work.hessian);
    timed(times.combinations, [&] { work.to_hessian.apply(work.hessian.data(), sum, out, pool_); });
    sum = out;
  }
}

void Program::set_offsets(const double* offset, double cost_offset) {
  std::copy_n(offset, rows(), linear_.offset.data());
  linear_.cost_offset = cost_offset;
  forget();
}

void Program::set_gather_offset(std::size_t term, const double* offset) {
  std::copy_n(offset, terms_[term].gather_offset.size(), terms_[term].gather_offset.data());
  forget();
}

void Program::set_constants(std::size_t term, const double* constants) {
  std::copy_n(constants, terms_[term].constants.size(), terms_[term].constants.data());
  forget();
}

}  // namespace robotraj::native
