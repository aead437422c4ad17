#include "stage_graph.hpp"

#include <cmath>
#include <limits>
#include <unordered_map>

namespace robotraj::native {

namespace {

using casadi::Function;
using casadi::SX;

Pattern pattern_of(const SX& matrix) {
  std::vector<casadi_int> rows, columns;
  matrix.sparsity().get_triplet(rows, columns);
  Pattern pattern;
  pattern.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) pattern.emplace_back(rows[i], columns[i]);
  return pattern;
}

SX nonzeros(const SX& matrix) { return SX(matrix.nonzeros()); }

SX joined(const std::vector<SX>& parts) {
  std::vector<casadi::SXElem> entries;
  for (const SX& part : parts) entries.insert(entries.end(), part.nonzeros().begin(), part.nonzeros().end());
  return SX(entries);
}

}  // namespace

std::vector<double> LinearPart::at(const double* constants, std::size_t count) const {
  const std::size_t in = numbers_.nnz_in(0), out = numbers_.nnz_out(0);
  std::vector<double> found(count * out);
  std::vector<const double*> arguments(numbers_.sz_arg());
  std::vector<double*> results(numbers_.sz_res());
  std::vector<casadi_int> integers(numbers_.sz_iw());
  std::vector<double> work(numbers_.sz_w());
  for (std::size_t point = 0; point < count; ++point) {
    arguments[0] = constants + point * in;
    results[0] = found.data() + point * out;
    numbers_(arguments.data(), results.data(), integers.data(), work.data());
  }
  return found;
}

StageGraph::StageGraph(const std::string& text) {
  const Function function = Function::deserialize(text);
  const std::vector<SX> in = function.sx_in(), out = function(in);
  v_ = in.at(0), c_ = in.at(1), r_ = in.at(2);
  y_ = SX::densify(out.at(0)), x_ = SX::densify(out.at(1));
}

Tape StageGraph::tape(const std::vector<SX>& more, const SX& result) const {
  std::vector<SX> inputs = {v_, c_};
  if (!r_.is_empty()) inputs.push_back(r_);
  inputs.insert(inputs.end(), more.begin(), more.end());
  return Tape(Function("tape", inputs, {result}));
}

StageGraph::Slopes StageGraph::slopes_of(const SX& y) const {
  const SX by_v = SX::jacobian(y, v_), by_r = SX::jacobian(y, r_);
  return {tape({}, joined({by_v, by_r})), pattern_of(by_v), pattern_of(by_r)};
}

Tape StageGraph::gradient(std::size_t which) const { return tape({}, SX::densify(SX::gradient(entry(which), v_))); }

StageGraph::Curvature StageGraph::curvature() const {
  const SX m = SX::sym("m", y_.numel());
  if (r_.is_empty()) {
    SX gradient;
    const SX vv = SX::tril(SX::hessian(SX::dot(m, y_), v_, gradient));
    return {tape({m}, nonzeros(vv)), pattern_of(vv), {}, {}};
  }
  const SX both = SX::vertcat({v_, r_});
  const SX first = SX::densify(SX::gradient(SX::dot(m, y_), both));
  const casadi_int n = v_.numel();
  const SX by_v = first(casadi::Slice(0, n)), by_r = first(casadi::Slice(n, first.numel()));
  const SX vv = SX::tril(SX::jacobian(by_v, v_)), rv = SX::jacobian(by_r, v_), rr = SX::jacobian(by_r, r_);
  return {tape({m}, joined({by_r, vv, rv, rr})), pattern_of(vv), pattern_of(rv), pattern_of(rr)};
}

std::optional<std::vector<std::int64_t>> StageGraph::places() const {
  std::unordered_map<casadi_int, std::int64_t> known;
  for (std::size_t i = 0; i < inputs(); ++i) known.emplace(v_.nonzeros()[i].__hash__(), i);
  std::vector<std::int64_t> places;
  for (const casadi::SXElem& each : x_.nonzeros()) {
    const auto found = known.find(each.__hash__());
    if (found != known.end()) places.push_back(found->second);
    else if (each.is_zero()) places.push_back(-1);
    else return std::nullopt;
  }
  return places;
}

StageGraph::Arguments StageGraph::chain() const {
  const SX by_v = SX::jacobian(x_, v_), g = SX::sym("g", x_.numel());
  SX gradient;
  const SX curvature = SX::tril(SX::hessian(SX::dot(g, x_), v_, gradient));
  return {Tape(Function("tape", {v_, c_}, {joined({x_, by_v})})),
          Tape(Function("tape", {v_, c_, g}, {nonzeros(curvature)})), pattern_of(by_v), pattern_of(curvature)};
}

std::vector<bool> StageGraph::turned() const {
  return r_.is_empty() ? std::vector<bool>(outputs(), false) : SX::which_depends(y_, r_, 1, true);
}

std::vector<bool> StageGraph::curved() const {
  std::vector<bool> bent = SX::which_depends(y_, v_, 2, true);
  const std::vector<bool> through = turned();
  for (std::size_t i = 0; i < bent.size(); ++i) bent[i] = bent[i] || through[i];
  return bent;
}

std::vector<double> StageGraph::constant_slopes() const {
  const SX by_v = SX::jacobian(y_, v_);
  const Pattern pattern = pattern_of(by_v);
  std::vector<double> slopes(outputs() * inputs(), 0.0);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const casadi::SXElem& entry = by_v.nonzeros()[i];
    slopes[pattern[i].second * outputs() + pattern[i].first] =
        entry.is_constant() ? static_cast<double>(entry) : unknown;
  }
  if (r_.is_empty()) return slopes;
  const std::vector<bool> through = turned(), moving = SX::which_depends(x_, v_, 1, false);
  for (std::size_t row = 0; row < outputs(); ++row)
    for (std::size_t column = 0; column < inputs(); ++column)
      if (through[row] && moving[column]) slopes[column * outputs() + row] = unknown;
  return slopes;
}

LinearPart StageGraph::linear(const std::vector<std::int64_t>& outputs) const {
  std::vector<casadi::SXElem> chosen;
  for (const std::int64_t which : outputs) chosen.push_back(y_.nonzeros().at(which));
  const SX part(chosen);
  const SX matrix = SX::jacobian(part, v_);
  const SX at_zero = SX::densify(SX::substitute(part, v_, SX::zeros(v_.size())));
  return {pattern_of(matrix), outputs.size(), Function("linear", {c_}, {joined({matrix, at_zero})})};
}

}  // namespace robotraj::native
