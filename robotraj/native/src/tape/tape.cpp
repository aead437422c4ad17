#include "tape.hpp"

#include <casadi/core/function.hpp>

#include <casadi/core/calculus.hpp>

#include <algorithm>
#include <limits>

namespace robotraj::native {

namespace {

Step step_of(std::int16_t operation) {
  switch (operation) {
    case casadi::OP_ADD: return Step::add;
    case casadi::OP_SUB:
    case casadi::OP_NEG: return Step::subtract;
    case casadi::OP_MUL: return Step::multiply;
    case casadi::OP_DIV: return Step::divide;
    case casadi::OP_SIN: return Step::sine;
    case casadi::OP_COS: return Step::cosine;
    default: return Step::other;
  }
}

/// Nodes in an order in which a result is not needed right after it is begun: of the next `kAhead` nodes, the one whose
/// operands are known for longest. A processor computes several nodes at once where they do not wait for each other.
Nodes interleaved(const ScalarGraph& graph, const Nodes& order) {
  constexpr std::size_t kAhead = 64;
  constexpr int kLatency = 12;  // nodes that are begun before a result is known
  std::vector<int> known(graph.size(), 0);
  Nodes found, ahead;
  auto next = order.begin();
  const auto ready = [&](Node node) {
    if (!graph.is_computed(node)) return 0;
    const ScalarGraph::Part& part = graph.part(node);
    return std::max(known[part.first], known[part.second]);
  };
  constexpr int kUnknown = std::numeric_limits<int>::max();
  for (const Node node : order) known[node] = kUnknown;
  for (int clock = 0; found.size() < order.size(); ++clock) {
    while (ahead.size() < kAhead && next != order.end()) ahead.push_back(*next++);
    auto best = ahead.begin();
    int least = kUnknown;
    for (auto each = ahead.begin(); each != ahead.end() && least > clock; ++each)
      if (const int at = ready(*each); at < least) {
        best = each;
        least = at;
      }
    known[*best] = graph.is_computed(*best) ? clock + kLatency : 0;
    found.push_back(*best);
    ahead.erase(best);
  }
  return found;
}

/// The memory of computed nodes: places of work that are free again, or of the result.
class Places {
 public:
  Places(const ScalarGraph& graph, const Nodes& order, const Nodes& results)
      : of(graph.size(), 0), uses_(graph.size(), 0), graph_(graph) {
    for (const Node each : order)
      if (graph.is_computed(each)) {
        ++uses_[graph.part(each).first];
        ++uses_[graph.part(each).second];
      }
    // Results stay where they are computed. A node that is several results is copied to the others.
    for (std::size_t k = 0; k < results.size(); ++k)
      if (std::int32_t& place = of[results[k]]; graph.is_computed(results[k]) && place == 0)
        place = -static_cast<std::int32_t>(k) - 1;
  }

  /// Finds a place for a node, whose operands may be needed no more.
  void take(Node node) {
    free(graph_.part(node).first);
    free(graph_.part(node).second);
    std::int32_t& place = of[node];
    if (place < 0) return;
    if (free_.empty()) free_.push_back(static_cast<std::int32_t>(size++));
    place = free_.back();
    free_.pop_back();
  }

  std::vector<std::int32_t> of;  ///< of each computed node; -k - 1 for the k-th result
  std::size_t size = 0;

 private:
  void free(Node node) {
    if (--uses_[node] > 0 || !graph_.is_computed(node)) return;
    if (const std::int32_t place = of[node]; place >= 0) free_.push_back(place);
  }

  std::vector<std::int32_t> uses_, free_;
  const ScalarGraph& graph_;
};

}  // namespace

Tape::Tape(const ScalarGraph& graph, const Nodes& results) : inputs_(graph.arguments()), outputs_(results.size()) {
  const Nodes order = interleaved(graph, graph.order(results));
  Places places(graph, order, results);
  for (const Node each : order)
    if (graph.is_computed(each)) places.take(each);
  work_ = places.size;
  std::vector<std::size_t> begin{work_};
  for (const std::size_t each : inputs_) begin.push_back(begin.back() + each);
  read_.assign(inputs_.size(), false);
  const auto constants_at = static_cast<std::int32_t>(begin.back());
  // Minus zero is the first constant: it changes no number that it is added to.
  constants_.push_back(-0.0);
  for (const Node each : order) {
    std::int32_t& place = places.of[each];
    const ScalarGraph::Part& part = graph.part(each);
    if (graph.is_constant(each)) {
      place = constants_at + static_cast<std::int32_t>(constants_.size());
      constants_.push_back(graph.value(each));
    } else if (graph.is_argument(each)) {
      read_[part.first] = true;
      place = static_cast<std::int32_t>(begin[part.first]) + part.second;
    }
  }
  result_ = constants_at + constants_.size();
  const auto place_of = [&](Node node) {
    const std::int32_t place = places.of[node];
    return place < 0 ? static_cast<std::int32_t>(result_) - place - 1 : place;
  };
  for (const Node each : order) {
    if (!graph.is_computed(each)) continue;
    const ScalarGraph::Part& part = graph.part(each);
    const bool negates = part.operation == casadi::OP_NEG;
    instructions_.push_back({place_of(each), negates ? constants_at : place_of(part.first), place_of(part.second),
                             step_of(part.operation), part.operation});
  }
  for (std::size_t k = 0; k < results.size(); ++k) {
    const auto to = static_cast<std::int32_t>(result_ + k);
    if (place_of(results[k]) != to)
      instructions_.push_back({to, place_of(results[k]), constants_at, Step::add, casadi::OP_ADD});
  }
}

TapeCode Tape::code() const {
  return {instructions_.data(), instructions_.size(), inputs_.data(), inputs_.size(),
          constants_.data(),    constants_.size(),    work_,          outputs_};
}

}  // namespace robotraj::native
