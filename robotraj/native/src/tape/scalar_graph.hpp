// A scalar graph whose nodes are numbers in a table: equal expressions are one node, and differentiation is cheap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace casadi {
class Function;
}

namespace robotraj::native {

/// A function is no scalar graph of dense results, or has calls of other functions in it.
struct NotATape : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Whether CasADi computes an operation from one or two numbers alone.
bool elementary(std::int64_t operation);
/// One operation as CasADi computes it.
double compute(std::int16_t operation, double x, double y);

using Node = std::int32_t;
using Nodes = std::vector<Node>;

/// Nodes in an order in which operands come before what is computed from them.
///
/// Sums with zeros, products with zeros and ones, double negatives and operations on constants are simplified: only
/// signs of zeros, infinities and NaN may differ.
class ScalarGraph {
 public:
  /// An operation of CasADi's. An argument has the numbers of the argument and of the entry in `first` and `second`,
  /// a constant its bits; operations of one number have it twice.
  struct Part {
    std::int16_t operation;
    Node first, second;
  };

  ScalarGraph();

  /// Adds an argument of a number of entries.
  Nodes add_argument(std::size_t entries);
  /// Reads an SXFunction of dense results: the nodes of its first arguments are given. Results of calls of other
  /// functions are arguments that are added to `called`; without it they throw NotATape.
  std::vector<Nodes> read(const casadi::Function& function, const std::vector<Nodes>& arguments,
                          Nodes* called = nullptr);
  /// Computes results of another graph from other nodes: those of its first arguments are given.
  Nodes read(const ScalarGraph& other, const Nodes& results, const std::vector<Nodes>& arguments);

  Node constant(double value);
  Node sum(Node a, Node b);
  Node difference(Node a, Node b);
  Node product(Node a, Node b);
  Node quotient(Node a, Node b);
  Node negative(Node a);
  Node operation(std::int64_t operation, Node a, Node b);

  std::size_t size() const { return parts_.size(); }
  const Part& part(Node node) const { return parts_[node]; }
  bool is_constant(Node node) const;
  bool is_argument(Node node) const;
  /// Whether a node is computed from other nodes.
  bool is_computed(Node node) const { return !is_constant(node) && !is_argument(node); }
  bool is(Node node, double value) const { return is_constant(node) && this->value(node) == value; }
  double value(Node constant) const;
  /// Entries of every argument.
  const std::vector<std::size_t>& arguments() const { return arguments_; }

  /// The nodes of which others are computed, operands first, each with its operands right before it where possible.
  Nodes order(const Nodes& results) const;
  /// Operations that results take.
  std::size_t operations(const Nodes& results) const;

 private:
  Node make(std::int16_t operation, Node a, Node b);
  void grow();

  std::vector<Part> parts_;
  std::vector<std::size_t> arguments_;
  std::vector<Node> table_;  // open addressing, -1 for an empty place
};

}  // namespace robotraj::native
