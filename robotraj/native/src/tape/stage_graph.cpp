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

Nodes joined(std::initializer_list<Nodes> parts) {
  Nodes all;
  for (const Nodes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

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

StageGraph::StageGraph(const std::string& text) : function_(Function::deserialize(text)) {
  const std::vector<SX> in = function_.sx_in(), out = function_(in);
  v_ = in.at(0), c_ = in.at(1), r_ = in.at(2);
  y_ = SX::densify(out.at(0)), x_ = SX::densify(out.at(1));
}

StageGraph::Scalars StageGraph::scalars(bool with_torques) const {
  Scalars found;
  found.v = found.graph.add_argument(v_.numel());
  found.c = found.graph.add_argument(c_.numel());
  if (!with_torques) found.r.assign(r_.numel(), found.graph.constant(0.0));
  else if (!r_.is_empty()) found.r = found.graph.add_argument(r_.numel());
  std::vector<Nodes> results = found.graph.read(function_, {found.v, found.c, found.r});
  found.y = std::move(results.at(0));
  found.x = std::move(results.at(1));
  return found;
}

Tape StageGraph::values() const {
  const Scalars own = scalars();
  return Tape(own.graph, own.y);
}

Tape StageGraph::output(std::size_t which) const {
  const Scalars own = scalars();
  return Tape(own.graph, {own.y.at(which)});
}

StageGraph::Slopes StageGraph::slopes_of(Scalars& own, const Nodes& y) {
  const auto n = static_cast<Node>(own.v.size());
  Nodes nodes;
  Slopes found;
  for (const Derivative& each : jacobian(own.graph, y, joined({own.v, own.r}))) {
    nodes.push_back(each.node);
    if (each.column < n) found.by_v.emplace_back(each.row, each.column);
    else found.by_r.emplace_back(each.row, each.column - n);
  }
  found.tape = Tape(own.graph, nodes);
  return found;
}

StageGraph::Slopes StageGraph::slopes() const {
  Scalars own = scalars();
  return slopes_of(own, own.y);
}

StageGraph::Slopes StageGraph::slopes(std::size_t which) const {
  Scalars own = scalars();
  return slopes_of(own, {own.y.at(which)});
}

Tape StageGraph::gradient(std::size_t which) const {
  Scalars own = scalars();
  const Nodes slopes = native::gradient(own.graph, {own.y.at(which)}, {own.graph.constant(1.0)}, own.v);
  return Tape(own.graph, slopes);
}

StageGraph::Curvature StageGraph::curvature() const {
  Scalars own = scalars();
  const Nodes m = own.graph.add_argument(own.y.size()), u = joined({own.v, own.r});
  const Nodes slopes = native::gradient(own.graph, own.y, m, u);
  const auto n = static_cast<Node>(own.v.size());
  Curvature found;
  Nodes vv, rv, rr;
  for (const Derivative& each : hessian(own.graph, slopes, u)) {
    const Node row = each.row - n, column = each.column - n;
    if (row < 0) {
      vv.push_back(each.node);
      found.vv.emplace_back(each.row, each.column);
    } else if (column < 0) {
      rv.push_back(each.node);
      found.rv.emplace_back(row, each.column);
    } else {
      rr.push_back(each.node);
      found.rr.emplace_back(row, column);
      if (row == column) continue;
      rr.push_back(each.node);
      found.rr.emplace_back(column, row);
    }
  }
  const Nodes by_r(slopes.begin() + n, slopes.end());
  found.tape = Tape(own.graph, joined({by_r, vv, rv, rr}));
  return found;
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
  // Arguments of the torques do not depend on them.
  Scalars first = scalars(false), second = scalars(false);
  Arguments found;
  Nodes slopes, curvature;
  for (const Derivative& each : jacobian(first.graph, first.x, first.v)) {
    slopes.push_back(each.node);
    found.by_v.emplace_back(each.row, each.column);
  }
  found.tape = Tape(first.graph, joined({first.x, slopes}));
  const Nodes g = second.graph.add_argument(second.x.size());
  const Nodes by_v = native::gradient(second.graph, second.x, g, second.v);
  for (const Derivative& each : hessian(second.graph, by_v, second.v)) {
    curvature.push_back(each.node);
    found.curvature.emplace_back(each.row, each.column);
  }
  found.curved = Tape(second.graph, curvature);
  return found;
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
