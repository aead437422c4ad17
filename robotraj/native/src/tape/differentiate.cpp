#include "differentiate.hpp"

#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

#include <casadi/core/calculus.hpp>

#include <algorithm>
#include <limits>
#include <map>

namespace robotraj::native {

namespace {

using casadi::SXElem;

constexpr Node kNone = -1;

/// Derivatives of a node by its operands.
struct Partials {
  Node first, second;  ///< `second` is kNone for operations of one number
};

/// CasADi's rules of derivatives, applied to nodes.
class Rules {
 public:
  explicit Rules(ScalarGraph& graph) : graph_(graph) {}

  Partials of(Node node) {
    const ScalarGraph::Part part = graph_.part(node);
    switch (part.operation) {
      case casadi::OP_ADD: return {graph_.constant(1.0), graph_.constant(1.0)};
      case casadi::OP_SUB: return {graph_.constant(1.0), graph_.constant(-1.0)};
      case casadi::OP_MUL: return {part.second, part.first};
      case casadi::OP_NEG: return {graph_.constant(-1.0), kNone};
      default: break;
    }
    SXElem slopes[2];
    casadi::casadi_math<SXElem>::der(static_cast<unsigned char>(part.operation), x_, y_, f_, slopes);
    const bool two = casadi::casadi_math<double>::ndeps(static_cast<unsigned char>(part.operation)) == 2;
    return {inserted(slopes[0], part, node), two ? inserted(slopes[1], part, node) : kNone};
  }

 private:
  Node inserted(const SXElem& rule, const ScalarGraph::Part& part, Node node) {
    if (rule.is_constant()) return graph_.constant(static_cast<double>(rule));
    if (rule.is_symbolic())
      return SXElem::is_equal(rule, x_, 0) ? part.first : SXElem::is_equal(rule, y_, 0) ? part.second : node;
    const Node first = inserted(rule.dep(0), part, node);
    return graph_.operation(rule.op(), first, rule.n_dep() > 1 ? inserted(rule.dep(1), part, node) : first);
  }

  ScalarGraph& graph_;
  SXElem x_ = SXElem::sym("x"), y_ = SXElem::sym("y"), f_ = SXElem::sym("f");
};

/// A sparse vector: places ascending.
using Row = std::vector<std::pair<Node, Node>>;

/// to += factor * from, of places from `first` to `last`.
void add(ScalarGraph& graph, const Row& from, Node factor, Node first, Node last, Row& to) {
  Row sum;
  sum.reserve(to.size() + from.size());
  auto old = to.begin();
  for (const auto& [place, node] : from) {
    if (place < first || place > last) continue;
    const Node more = graph.product(factor, node);
    if (graph.is(more, 0.0)) continue;
    while (old != to.end() && old->first < place) sum.push_back(*old++);
    if (old != to.end() && old->first == place) sum.emplace_back(place, graph.sum((old++)->second, more));
    else sum.emplace_back(place, more);
  }
  sum.insert(sum.end(), old, to.end());
  to = std::move(sum);
}

/// The range of entries of u by which a result is differentiated.
struct Range {
  Node first, last;
};

/// Derivatives of each result, forward from u.
std::vector<Row> forward(ScalarGraph& graph, const Nodes& results, const std::vector<Range>& ranges, const Nodes& u) {
  const Nodes order = graph.order(results);
  std::vector<Range> wanted(graph.size(), {std::numeric_limits<Node>::max(), kNone});
  const auto widen = [&](Node node, const Range& range) {
    Range& own = wanted[node];
    own = {std::min(own.first, range.first), std::max(own.last, range.last)};
  };
  for (std::size_t k = 0; k < results.size(); ++k) widen(results[k], ranges[k]);
  for (auto each = order.rbegin(); each != order.rend(); ++each)
    if (graph.is_computed(*each)) {
      const Range own = wanted[*each];
      widen(graph.part(*each).first, own);
      widen(graph.part(*each).second, own);
    }
  Rules rules(graph);
  const std::vector<bool> depends = dependent(graph, order, u);
  std::vector<Row> rows(depends.size());
  for (std::size_t k = 0; k < u.size(); ++k) rows[u[k]] = {{static_cast<Node>(k), graph.constant(1.0)}};
  for (const Node each : order) {
    if (!depends[each] || !graph.is_computed(each)) continue;
    const ScalarGraph::Part part = graph.part(each);
    const Partials by = rules.of(each);
    const auto [first, last] = wanted[each];
    add(graph, rows[part.first], by.first, first, last, rows[each]);
    if (by.second != kNone) add(graph, rows[part.second], by.second, first, last, rows[each]);
  }
  std::vector<Row> found;
  for (const Node result : results) found.push_back(rows[result]);
  return found;
}

/// Derivatives of all results by every node that depends on u, backward from the results; `seeds` are their rows.
std::vector<Row> adjoints(ScalarGraph& graph, const Nodes& results, const std::vector<Row>& seeds, const Nodes& u) {
  const Nodes order = graph.order(results);
  Rules rules(graph);
  const std::vector<bool> depends = dependent(graph, order, u);
  std::vector<Row> rows(depends.size());
  const Node one = graph.constant(1.0), last = std::numeric_limits<Node>::max();
  for (std::size_t k = 0; k < results.size(); ++k)
    if (const Node at = results[k]; depends[at]) add(graph, seeds[k], one, 0, last, rows[at]);
  for (auto each = order.rbegin(); each != order.rend(); ++each) {
    const Node at = *each;
    if (!depends[at] || rows[at].empty() || !graph.is_computed(*each)) continue;
    const ScalarGraph::Part part = graph.part(*each);
    const Partials by = rules.of(*each);
    const Row& own = rows[at];
    const auto pass = [&](Node to, Node factor) {
      if (factor != kNone && depends[to]) add(graph, own, factor, 0, last, rows[to]);
    };
    pass(part.first, by.first);
    pass(part.second, by.second);
  }
  return rows;
}

/// Derivatives of all results by each of u.
std::vector<Row> backward(ScalarGraph& graph, const Nodes& results, const std::vector<Row>& seeds, const Nodes& u) {
  std::vector<Row> rows = adjoints(graph, results, seeds, u), found;
  for (const Node each : u) found.push_back(std::move(rows[each]));
  return found;
}

/// One seed for each result: its weight.
std::vector<Row> weighted(const Nodes& weights) {
  std::vector<Row> seeds;
  for (const Node each : weights) seeds.push_back({{0, each}});
  return seeds;
}

Nodes nodes_of(const Derivatives& derivatives) {
  Nodes nodes;
  for (const Derivative& each : derivatives) nodes.push_back(each.node);
  return nodes;
}

Derivatives in_order(Derivatives derivatives) {
  std::sort(derivatives.begin(), derivatives.end(), [](const Derivative& a, const Derivative& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  return derivatives;
}

const Derivatives& shorter(const ScalarGraph& graph, const Derivatives& a, const Derivatives& b) {
  return graph.operations(nodes_of(a)) <= graph.operations(nodes_of(b)) ? a : b;
}

}  // namespace

std::vector<bool> dependent(const ScalarGraph& graph, const Nodes& order, const Nodes& u) {
  std::vector<bool> found(graph.size(), false);
  for (const Node each : u) found[each] = true;
  for (const Node each : order)
    if (graph.is_computed(each)) found[each] = found[graph.part(each).first] || found[graph.part(each).second];
  return found;
}

Derivatives jacobian(ScalarGraph& graph, const Nodes& y, const Nodes& u) {
  const auto last = static_cast<Node>(u.size());
  const std::vector<Row> by_rows = forward(graph, y, std::vector<Range>(y.size(), Range{0, last}), u);
  Derivatives ahead, back;
  for (std::size_t i = 0; i < y.size(); ++i)
    for (const auto& [column, node] : by_rows[i]) ahead.push_back({static_cast<Node>(i), column, node});
  std::vector<Row> seeds;
  for (std::size_t i = 0; i < y.size(); ++i) seeds.push_back({{static_cast<Node>(i), graph.constant(1.0)}});
  const std::vector<Row> by_columns = backward(graph, y, seeds, u);
  for (std::size_t k = 0; k < u.size(); ++k)
    for (const auto& [row, node] : by_columns[k]) back.push_back({row, static_cast<Node>(k), node});
  return in_order(shorter(graph, ahead, back));
}

Nodes gradient(ScalarGraph& graph, const Nodes& y, const Nodes& m, const Nodes& u) {
  Nodes found;
  for (const Row& row : backward(graph, y, weighted(m), u))
    found.push_back(row.empty() ? graph.constant(0.0) : row.front().second);
  return found;
}

Derivatives hessian(ScalarGraph& graph, const Nodes& gradient, const Nodes& u) {
  const auto size = static_cast<Node>(u.size());
  std::vector<Range> lower, upper;
  for (Node k = 0; k < size; ++k) {
    lower.push_back({0, k});
    upper.push_back({k, size});
  }
  Derivatives below, above;
  const std::vector<Row> rows = forward(graph, gradient, lower, u), columns = forward(graph, gradient, upper, u);
  for (Node k = 0; k < size; ++k) {
    for (const auto& [place, node] : rows[k])
      if (place <= k) below.push_back({k, place, node});
    for (const auto& [place, node] : columns[k])
      if (place >= k) above.push_back({place, k, node});
  }
  return in_order(shorter(graph, below, above));
}

std::optional<Nodes> convexified(ScalarGraph& graph, const Derivatives& exact, const Nodes& y, const Nodes& m,
                                 const Nodes& u) {
  const Nodes order = graph.order(y);
  const std::vector<bool> depends = dependent(graph, order, u);
  Nodes saturations, operands;
  for (const Node each : order)
    if (graph.part(each).operation == casadi::OP_TANH && depends[each]) {
      saturations.push_back(each);
      operands.push_back(graph.part(each).first);
    }
  if (saturations.empty()) return std::nullopt;
  std::map<std::pair<Node, Node>, std::size_t> index;
  for (std::size_t i = 0; i < exact.size(); ++i) index.emplace(std::pair(exact[i].row, exact[i].column), i);
  Nodes found = nodes_of(exact);
  const std::vector<Row> weights = adjoints(graph, y, weighted(m), u);
  const auto last = static_cast<Node>(u.size());
  const std::vector<Row> slopes = forward(graph, operands, std::vector<Range>(operands.size(), Range{0, last}), u);
  for (std::size_t k = 0; k < saturations.size(); ++k) {
    const Node t = saturations[k];
    const Row& weight = weights[t];
    if (weight.empty()) continue;
    const Node slope = graph.difference(graph.constant(1.0), graph.product(t, t));
    const Node curvature =
        graph.product(weight.front().second, graph.product(graph.constant(-2.0), graph.product(t, slope)));
    const Node negative = graph.operation(casadi::OP_FMIN, curvature, graph.constant(0.0));
    for (const auto& [row, by_row] : slopes[k])
      for (const auto& [column, by_column] : slopes[k]) {
        const auto at = index.find({row, column});
        if (at == index.end()) continue;
        Node& entry = found[at->second];
        entry = graph.difference(entry, graph.product(negative, graph.product(by_row, by_column)));
      }
  }
  return found;
}

}  // namespace robotraj::native
