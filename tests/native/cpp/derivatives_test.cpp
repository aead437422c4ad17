// Derivatives of scalar graphs against CasADi's, and tapes against the graphs of which they are made.
#include <casadi/casadi.hpp>

#include <cmath>
#include <random>

#include "check.hpp"
#include "tape/differentiate.hpp"
#include "tape/tape.hpp"

namespace robotraj::tests {

namespace {

using casadi::DM;
using casadi::Function;
using casadi::SX;
using native::Derivatives;
using native::Nodes;
using native::ScalarGraph;
using native::Tape;

/// Runs a tape at one point, instruction by instruction.
std::vector<double> run(const Tape& tape, const std::vector<std::vector<double>>& arguments) {
  const native::TapeCode code = tape.code();
  std::vector<double> memory(code.work, 0.0);
  for (const std::vector<double>& argument : arguments) memory.insert(memory.end(), argument.begin(), argument.end());
  memory.insert(memory.end(), code.constants, code.constants + code.constant_count);
  memory.resize(tape.memory());
  const auto at = [&memory](std::int32_t place) -> double& { return memory.at(static_cast<std::size_t>(place)); };
  for (std::size_t k = 0; k < code.count; ++k) {
    const native::Instruction& each = code.instructions[k];
    const double x = at(each.first), y = at(each.second);
    switch (each.step) {
      case native::Step::add: at(each.out) = x + y; break;
      case native::Step::subtract: at(each.out) = x - y; break;
      case native::Step::multiply: at(each.out) = x * y; break;
      case native::Step::divide: at(each.out) = x / y; break;
      default: at(each.out) = native::compute(each.operation, x, y);
    }
  }
  return {memory.end() - static_cast<std::ptrdiff_t>(code.outputs), memory.end()};
}

/// Functions of three numbers and one constant; the last one has every operation with a derivative of its own.
std::vector<SX> functions(const SX& u, const SX& c) {
  const SX a = u(0), b = u(1), d = u(2);
  return {
      SX::vertcat({a * b + sin(a) * cos(b * d), c * a - b, SX(3.0), d, a - (-b) * (-d), a * b + sin(a) * cos(b * d)}),
      SX::vertcat({sqrt(1 + a * a + b * b) / (2 + cos(d)), 1 / (2 + sin(a * c)), exp(a) * log(2 + b * b)}),
      SX::vertcat({pow(2 + sin(a), b), tan(a / 3) + asin(sin(b) / 2) + acos(cos(d) / 2), atan2(a, 2 + b * b) + atan(d),
                   if_else(a > b, a * d, b * b), fmin(a, b) * fmax(b, d) + fabs(a) * sign(b), erf(a) * floor(d),
                   tanh(a) + sinh(b) * cosh(d), asinh(a) + acosh(2 + b * b) + atanh(sin(d) / 2), copysign(a, b) * c}),
  };
}

void check_close(const std::vector<double>& found, const DM& wanted) {
  CHECK(found.size() == static_cast<std::size_t>(wanted.numel()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double expected = static_cast<double>(wanted(static_cast<casadi_int>(i)));
    CHECK(std::abs(found[i] - expected) <= 1e-12 * (1.0 + std::abs(expected)));
  }
}

Nodes nodes_of(const Derivatives& derivatives) {
  Nodes nodes;
  for (const auto& each : derivatives) nodes.push_back(each.node);
  return nodes;
}

/// Entries of a matrix at the places of derivatives; others must be zero.
DM entries(const DM& matrix, const Derivatives& derivatives) {
  DM left = matrix, found = DM::zeros(static_cast<casadi_int>(derivatives.size()));
  for (std::size_t i = 0; i < derivatives.size(); ++i) {
    found(static_cast<casadi_int>(i)) = matrix(derivatives[i].row, derivatives[i].column);
    left(derivatives[i].row, derivatives[i].column) = 0.0;
  }
  CHECK(static_cast<double>(DM::norm_fro(left)) == 0.0);
  return found;
}

}  // namespace

ROBOTRAJ_TEST(derivatives_of_graphs_are_those_of_casadi) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> within(-1.5, 1.5);
  const SX u = SX::sym("u", 3), c = SX::sym("c");
  for (const SX& y : functions(u, c)) {
    const SX m = SX::sym("m", y.numel());
    const Function values("values", {u, c}, {y});
    SX by_u;
    const SX second = SX::hessian(SX::dot(m, y), u, by_u);
    const Function derivatives("derivatives", {u, c, m},
                               {SX::densify(SX::jacobian(y, u)), SX::densify(by_u), SX::densify(SX::tril(second))});
    ScalarGraph graph;
    const Nodes own = graph.add_argument(3), constant = graph.add_argument(1);
    const Nodes results = graph.read(values, {own, constant}).front();
    const Nodes multipliers = graph.add_argument(results.size());
    const Derivatives jacobian = native::jacobian(graph, results, own);
    const Nodes gradient = native::gradient(graph, results, multipliers, own);
    const Derivatives hessian = native::hessian(graph, gradient, own);
    for (int point = 0; point < 20; ++point) {
      const std::vector<double> at{within(random), within(random), within(random)}, with{within(random)};
      std::vector<double> factors;
      for (std::size_t i = 0; i < results.size(); ++i) factors.push_back(within(random));
      check_close(run(Tape(graph, results), {at, with, factors}), values(std::vector<DM>{at, with}).at(0));
      const std::vector<DM> wanted = derivatives(std::vector<DM>{at, with, factors});
      check_close(run(Tape(graph, nodes_of(jacobian)), {at, with, factors}), entries(wanted[0], jacobian));
      check_close(run(Tape(graph, gradient), {at, with, factors}), wanted[1]);
      check_close(run(Tape(graph, nodes_of(hessian)), {at, with, factors}), entries(wanted[2], hessian));
    }
  }
}

ROBOTRAJ_TEST(saturations_keep_their_positive_curvature_alone) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-1.5, 1.5);
  const SX u = SX::sym("u", 3), c = SX::sym("c"), m = SX::sym("m", 3);
  const SX operands = SX::vertcat({3 * u(0) / (2 + u(1)), u(2) * c}), t = tanh(operands);
  const SX y = SX::vertcat({u(0) * u(2) - 2 * t(0), u(1) * t(1) + t(0), u(0) * u(1)});
  // The weights of both saturations are no functions of their operands.
  const SX weights = SX::vertcat({m(1) - 2 * m(0), m(1) * u(1)}), slopes = SX::jacobian(operands, u);
  SX wanted = SX::hessian(SX::dot(m, y), u);
  for (casadi_int k = 0; k < 2; ++k) {
    const SX curvature = -2 * weights(k) * t(k) * (1 - t(k) * t(k)), by_u = slopes(k, casadi::Slice());
    wanted -= fmin(curvature, 0) * mtimes(by_u.T(), by_u);
  }
  const Function convex("convex", {u, c, m}, {SX::densify(SX::tril(wanted))});
  ScalarGraph graph;
  const Nodes own = graph.add_argument(3), constant = graph.add_argument(1);
  const Nodes results = graph.read(Function("y", {u, c}, {y}), {own, constant}).front();
  const Nodes multipliers = graph.add_argument(3);
  const Derivatives exact = native::hessian(graph, native::gradient(graph, results, multipliers, own), own);
  const auto found = native::convexified(graph, exact, results, multipliers, own);
  CHECK(found.has_value());
  for (int point = 0; point < 20; ++point) {
    std::vector<double> at, factors;
    for (int i = 0; i < 3; ++i) {
      at.push_back(within(random));
      factors.push_back(within(random));
    }
    const std::vector<double> with{within(random)};
    const DM matrix = convex(std::vector<DM>{at, with, factors}).at(0);
    check_close(run(Tape(graph, *found), {at, with, factors}), entries(matrix, exact));
  }
  CHECK(!native::convexified(graph, exact, {results[2]}, {multipliers[2]}, own).has_value());
}

ROBOTRAJ_TEST(equal_expressions_are_one_node) {
  ScalarGraph graph;
  const Nodes x = graph.add_argument(2);
  const native::Node product = graph.product(x[0], x[1]);
  CHECK(graph.product(x[1], x[0]) == product);
  CHECK(graph.sum(product, graph.constant(0.0)) == product);
  CHECK(graph.negative(graph.negative(product)) == product);
  CHECK(graph.is(graph.difference(product, product), 0.0));
  CHECK(graph.is(graph.sum(graph.constant(2.0), graph.constant(3.0)), 5.0));
  // A result may be an argument, a constant or one of the others.
  const Tape tape(graph, {product, x[1], product, graph.constant(7.0), x[1]});
  const std::vector<double> found = run(tape, {{3.0, 4.0}});
  CHECK((found == std::vector<double>{12.0, 4.0, 12.0, 7.0, 4.0}));
}

}  // namespace robotraj::tests
