#include "scalar_graph.hpp"

// calculus.hpp uses macros that headers of function.hpp define.
#include <casadi/core/function.hpp>

#include <casadi/core/calculus.hpp>

#include <algorithm>
#include <cstring>

namespace robotraj::native {

namespace {

constexpr std::size_t kFirstTable = 1024;

std::size_t hash(std::int16_t operation, Node a, Node b) {
  std::uint64_t key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
  key = (key ^ (static_cast<std::uint64_t>(operation) << 57)) * 0x9E3779B97F4A7C15u;
  return key ^ (key >> 29);
}

}  // namespace

bool elementary(std::int64_t operation) {
  switch (operation) {
    case casadi::OP_ERFINV:
    case casadi::OP_LOG1P:
    case casadi::OP_EXPM1:
    case casadi::OP_HYPOT:
    case casadi::OP_REMAINDER: return true;
    default: return operation <= casadi::OP_ATAN2;
  }
}

double compute(std::int16_t operation, double x, double y) {
  double result = 0.0;
  casadi::casadi_math<double>::fun(static_cast<unsigned char>(operation), x, y, result);
  return result;
}

ScalarGraph::ScalarGraph() : table_(kFirstTable, -1) {}

Nodes ScalarGraph::add_argument(std::size_t entries) {
  Nodes nodes;
  for (std::size_t k = 0; k < entries; ++k)
    nodes.push_back(make(casadi::OP_INPUT, static_cast<Node>(arguments_.size()), static_cast<Node>(k)));
  arguments_.push_back(entries);
  return nodes;
}

std::vector<Nodes> ScalarGraph::read(const casadi::Function& function, const std::vector<Nodes>& arguments,
                                     Nodes* called) {
  if (!function.is_a("SXFunction")) throw NotATape(function.name() + " is no scalar graph");
  std::vector<Nodes> results;
  for (casadi_int i = 0; i < function.n_out(); ++i) {
    if (!function.sparsity_out(i).is_dense()) throw NotATape("a result of " + function.name() + " is not dense");
    results.emplace_back(function.nnz_out(i));
  }
  Nodes work(function.sz_w());
  const casadi_int count = function.n_instructions();
  for (casadi_int k = 0; k < count; ++k) {
    const casadi_int operation = function.instruction_id(k);
    const std::vector<casadi_int> out = function.instruction_output(k);
    if (operation == casadi::OP_CONST) {
      work[out[0]] = constant(function.instruction_constant(k));
      continue;
    }
    const std::vector<casadi_int> in = function.instruction_input(k);
    if (operation == casadi::OP_INPUT) work[out[0]] = arguments.at(in[0]).at(in[1]);
    else if (operation == casadi::OP_OUTPUT) results[out[0]][out[1]] = work[in[0]];
    else if (elementary(operation))
      work[out[0]] = this->operation(operation, work[in[0]], work[in.size() > 1 ? in[1] : in[0]]);
    else if (!called) throw NotATape(function.name() + " calls another function");
    else
      for (const casadi_int each : out)
        if (each >= 0) called->push_back(work[each] = add_argument(1).front());
  }
  return results;
}

Nodes ScalarGraph::read(const ScalarGraph& other, const Nodes& results, const std::vector<Nodes>& arguments) {
  Nodes copies(other.size());
  const auto copy_of = [&](Node node) { return copies[node]; };
  for (const Node each : other.order(results)) {
    const Part& part = other.part(each);
    Node& copy = copies[each];
    if (other.is_constant(each)) copy = constant(other.value(each));
    else if (other.is_argument(each)) copy = arguments.at(part.first).at(part.second);
    else copy = operation(part.operation, copy_of(part.first), copy_of(part.second));
  }
  Nodes found;
  for (const Node each : results) found.push_back(copy_of(each));
  return found;
}

bool ScalarGraph::is_constant(Node node) const { return part(node).operation == casadi::OP_CONST; }
bool ScalarGraph::is_argument(Node node) const { return part(node).operation == casadi::OP_INPUT; }

Node ScalarGraph::make(std::int16_t operation, Node a, Node b) {
  std::size_t at = hash(operation, a, b) & (table_.size() - 1);
  for (; table_[at] >= 0; at = (at + 1) & (table_.size() - 1)) {
    const Part& known = part(table_[at]);
    if (known.operation == operation && known.first == a && known.second == b) return table_[at];
  }
  const auto node = static_cast<Node>(parts_.size());
  table_[at] = node;
  parts_.push_back({operation, a, b});
  if (2 * parts_.size() > table_.size()) grow();
  return node;
}

void ScalarGraph::grow() {
  table_.assign(2 * table_.size(), -1);
  for (std::size_t node = 0; node < parts_.size(); ++node) {
    const Part& each = parts_[node];
    std::size_t at = hash(each.operation, each.first, each.second) & (table_.size() - 1);
    while (table_[at] >= 0) at = (at + 1) & (table_.size() - 1);
    table_[at] = static_cast<Node>(node);
  }
}

Node ScalarGraph::constant(double value) {
  Node bits[2];
  std::memcpy(bits, &value, sizeof bits);
  return make(casadi::OP_CONST, bits[0], bits[1]);
}

double ScalarGraph::value(Node constant) const {
  const Node bits[2] = {part(constant).first, part(constant).second};
  double value;
  std::memcpy(&value, bits, sizeof value);
  return value;
}

Node ScalarGraph::negative(Node a) {
  if (is_constant(a)) return constant(-value(a));
  if (part(a).operation == casadi::OP_NEG) return part(a).first;
  return make(casadi::OP_NEG, a, a);
}

Node ScalarGraph::sum(Node a, Node b) {
  if (is_constant(a) && is_constant(b)) return constant(value(a) + value(b));
  if (is(a, 0.0)) return b;
  if (is(b, 0.0)) return a;
  if (part(b).operation == casadi::OP_NEG) return difference(a, part(b).first);
  if (part(a).operation == casadi::OP_NEG) return difference(b, part(a).first);
  return make(casadi::OP_ADD, std::min(a, b), std::max(a, b));
}

Node ScalarGraph::difference(Node a, Node b) {
  if (is_constant(a) && is_constant(b)) return constant(value(a) - value(b));
  if (is(a, 0.0)) return negative(b);
  if (is(b, 0.0)) return a;
  if (a == b) return constant(0.0);
  if (part(b).operation == casadi::OP_NEG) return sum(a, part(b).first);
  return make(casadi::OP_SUB, a, b);
}

Node ScalarGraph::product(Node a, Node b) {
  if (is_constant(a) && is_constant(b)) return constant(value(a) * value(b));
  if (is(a, 0.0) || is(b, 0.0)) return constant(0.0);
  if (is(a, 1.0)) return b;
  if (is(b, 1.0)) return a;
  if (is(a, -1.0)) return negative(b);
  if (is(b, -1.0)) return negative(a);
  if (part(a).operation == casadi::OP_NEG) return negative(product(part(a).first, b));
  if (part(b).operation == casadi::OP_NEG) return negative(product(a, part(b).first));
  return make(casadi::OP_MUL, std::min(a, b), std::max(a, b));
}

Node ScalarGraph::quotient(Node a, Node b) {
  if (is_constant(a) && is_constant(b)) return constant(value(a) / value(b));
  if (is(a, 0.0)) return a;
  if (is(b, 1.0)) return a;
  return make(casadi::OP_DIV, a, b);
}

Node ScalarGraph::operation(std::int64_t operation, Node a, Node b) {
  switch (operation) {
    case casadi::OP_ASSIGN: return a;
    case casadi::OP_ADD: return sum(a, b);
    case casadi::OP_SUB: return difference(a, b);
    case casadi::OP_MUL: return product(a, b);
    case casadi::OP_DIV: return quotient(a, b);
    case casadi::OP_NEG: return negative(a);
    case casadi::OP_SQ: return product(a, a);
    case casadi::OP_TWICE: return sum(a, a);
    case casadi::OP_INV: return quotient(constant(1.0), a);
    default: break;
  }
  const auto narrow = static_cast<std::int16_t>(operation);
  if (is_constant(a) && is_constant(b)) return constant(compute(narrow, value(a), value(b)));
  return make(narrow, a, b);
}

Nodes ScalarGraph::order(const Nodes& results) const {
  std::vector<bool> known(size(), false);
  Nodes found;
  std::vector<std::pair<Node, bool>> pending;
  for (const Node result : results) {
    pending.emplace_back(result, false);
    while (!pending.empty()) {
      const auto [node, ready] = pending.back();
      pending.pop_back();
      if (ready) {
        found.push_back(node);
        continue;
      }
      if (known[node]) continue;
      known[node] = true;
      pending.emplace_back(node, true);
      if (!is_computed(node)) continue;
      pending.emplace_back(part(node).second, false);
      pending.emplace_back(part(node).first, false);
    }
  }
  return found;
}

std::size_t ScalarGraph::operations(const Nodes& results) const {
  std::size_t count = 0;
  for (const Node node : order(results)) count += is_computed(node);
  return count;
}

}  // namespace robotraj::native
