#include "stage_graph.hpp"

#include <casadi/core/function.hpp>

#include <limits>
#include <unordered_map>

namespace robotraj::native {

namespace {

Nodes joined(std::initializer_list<Nodes> parts) {
  Nodes all;
  for (const Nodes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

StageGraph::StageGraph(const std::string& text) {
  const casadi::Function function = casadi::Function::deserialize(text);
  v_ = graph_.add_argument(function.nnz_in(0));
  c_ = graph_.add_argument(function.nnz_in(1));
  if (function.nnz_in(2) > 0) r_ = graph_.add_argument(function.nnz_in(2));
  std::vector<Nodes> results = graph_.read(function, {v_, c_, r_}, &called_);
  y_ = std::move(results.at(0));
  x_ = std::move(results.at(1));
}

StageGraph StageGraph::selected(const std::vector<std::int64_t>& outputs) const {
  StageGraph made;
  made.graph_ = graph_;
  made.v_ = v_, made.c_ = c_, made.r_ = r_, made.x_ = x_, made.called_ = called_;
  for (const std::int64_t which : outputs) made.y_.push_back(y_.at(which));
  return made;
}

ScalarGraph StageGraph::scalars() const {
  if (!called_.empty()) throw NotATape("the function calls another function");
  return graph_;
}

Nodes StageGraph::moving() const { return joined({v_, r_, called_}); }

Tape StageGraph::values() const { return Tape(scalars(), y_); }

std::tuple<Tape, Pattern, Pattern> StageGraph::slopes() const {
  ScalarGraph own = scalars();
  const auto n = static_cast<Node>(v_.size());
  Nodes nodes;
  Pattern by_v, by_r;
  for (const Derivative& each : jacobian(own, y_, joined({v_, r_}))) {
    nodes.push_back(each.node);
    if (each.column < n) by_v.add(each.row, each.column);
    else by_r.add(each.row, each.column - n);
  }
  return {Tape(own, nodes), std::move(by_v), std::move(by_r)};
}

Tape StageGraph::gradient() const {
  ScalarGraph own = scalars();
  const Nodes slopes = native::gradient(own, {y_.at(0)}, {own.constant(1.0)}, v_);
  return Tape(own, slopes);
}

std::tuple<Tape, std::optional<Tape>, Pattern, Pattern, Pattern> StageGraph::curvature() const {
  ScalarGraph own = scalars();
  const Nodes m = own.add_argument(y_.size()), u = joined({v_, r_});
  const Nodes slopes = native::gradient(own, y_, m, u);
  const auto n = static_cast<Node>(v_.size());
  const Derivatives entries = hessian(own, slopes, u);
  // Places among the entries, in the order of the tape.
  std::vector<std::size_t> vv, rv, rr;
  Pattern of_vv, of_rv, of_rr;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Node row = entries[i].row - n, column = entries[i].column - n;
    if (row < 0) {
      vv.push_back(i);
      of_vv.add(entries[i].row, entries[i].column);
    } else if (column < 0) {
      rv.push_back(i);
      of_rv.add(row, entries[i].column);
    } else {
      rr.push_back(i);
      of_rr.add(row, column);
      if (row == column) continue;
      rr.push_back(i);
      of_rr.add(column, row);
    }
  }
  const auto tape = [&](const Nodes& of_entries) {
    Nodes nodes(slopes.begin() + n, slopes.end());
    for (const auto* places : {&vv, &rv, &rr})
      for (const std::size_t place : *places) nodes.push_back(of_entries[place]);
    return Tape(own, nodes);
  };
  Nodes exact;
  for (const Derivative& each : entries) exact.push_back(each.node);
  Tape of_all = tape(exact);
  const std::optional<Nodes> convex = convexified(own, entries, y_, m, u);
  return {std::move(of_all), convex ? std::optional(tape(*convex)) : std::nullopt, std::move(of_vv), std::move(of_rv),
          std::move(of_rr)};
}

std::optional<std::vector<std::int64_t>> StageGraph::places() const {
  std::unordered_map<Node, std::int64_t> known;
  for (std::size_t i = 0; i < v_.size(); ++i) known.emplace(v_[i], i);
  std::vector<std::int64_t> places;
  for (const Node each : x_) {
    const auto found = known.find(each);
    if (found != known.end()) places.push_back(found->second);
    else if (graph_.is(each, 0.0)) places.push_back(-1);
    else return std::nullopt;
  }
  return places;
}

std::tuple<Tape, Tape, Pattern, Pattern> StageGraph::chain() const {
  // Arguments of the torques do not depend on them.
  ScalarGraph first;
  const Nodes v = first.add_argument(v_.size()), c = first.add_argument(c_.size());
  const Nodes x = first.read(scalars(), x_, {v, c});
  ScalarGraph second = first;
  Nodes slopes, curvature;
  Pattern by_v, of_curvature;
  for (const Derivative& each : jacobian(first, x, v)) {
    slopes.push_back(each.node);
    by_v.add(each.row, each.column);
  }
  const Nodes g = second.add_argument(x.size());
  const Nodes gradient = native::gradient(second, x, g, v);
  for (const Derivative& each : hessian(second, gradient, v)) {
    curvature.push_back(each.node);
    of_curvature.add(each.row, each.column);
  }
  return {Tape(first, joined({x, slopes})), Tape(second, curvature), std::move(by_v), std::move(of_curvature)};
}

std::tuple<std::vector<std::int64_t>, Tape, Pattern> StageGraph::split() const {
  ScalarGraph own = graph_;
  const Nodes u = moving();
  const Derivatives slopes = jacobian(own, y_, u);
  Nodes nodes;
  for (const Derivative& each : slopes) nodes.push_back(each.node);
  const std::vector<bool> moves = dependent(own, own.order(nodes), u);
  std::vector<bool> curved(y_.size(), false);
  for (const Derivative& each : slopes)
    if (static_cast<std::size_t>(each.column) >= v_.size() || moves[each.node]) curved[each.row] = true;

  std::vector<std::int64_t> left;
  std::vector<std::int64_t> number(y_.size(), -1);
  Nodes chosen, entries;
  for (std::size_t i = 0; i < y_.size(); ++i) {
    if (curved[i]) {
      left.push_back(static_cast<std::int64_t>(i));
    } else {
      number[i] = static_cast<std::int64_t>(chosen.size());
      chosen.push_back(y_[i]);
    }
  }
  Pattern pattern;
  for (const Derivative& each : slopes)
    if (const std::int64_t row = number[each.row]; row >= 0) {
      entries.push_back(each.node);
      pattern.add(row, each.column);
    }
  // The outputs at v = 0; entries of A do not depend on v.
  ScalarGraph at_zero;
  at_zero.add_argument(0);
  const Nodes c = at_zero.add_argument(c_.size()), zeros(v_.size(), at_zero.constant(0.0));
  const Nodes numbers = at_zero.read(own, joined({entries, chosen}), {zeros, c});
  return {std::move(left), Tape(at_zero, numbers), std::move(pattern)};
}

std::vector<double> StageGraph::constant_slopes() const {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  ScalarGraph own = graph_;
  const std::size_t n = v_.size();
  std::vector<double> slopes(outputs() * n, 0.0);
  // Torques move with the entries of v on which their arguments depend; results of calls may move with all of them.
  std::vector<bool> moving(n, !called_.empty());
  for (const Derivative& each : jacobian(own, x_, v_)) moving[each.column] = true;
  for (const Derivative& each : jacobian(own, y_, this->moving())) {
    const auto row = static_cast<std::size_t>(each.row), column = static_cast<std::size_t>(each.column);
    if (column < n) {
      double& slope = slopes[column * outputs() + row];
      slope += own.is_constant(each.node) ? own.value(each.node) : unknown;
      continue;
    }
    for (std::size_t k = 0; k < n; ++k)
      if (moving[k]) slopes[k * outputs() + row] = unknown;
  }
  return slopes;
}

}  // namespace robotraj::native
