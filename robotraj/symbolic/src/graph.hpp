// What all algorithms share: a model on casadi::SX, and the construction of a Function.
#pragma once

#include "tree.hpp"

#include <memory>
#include <string>
#include <vector>

namespace robotraj {

/// Column-major dense copy; structural zeros become the constant 0, so every output has a fixed layout.
template <typename Derived>
SX to_casadi(const Eigen::MatrixBase<Derived>& source) {
  SX result = SX::zeros(source.rows(), source.cols());
  auto& elements = result.nonzeros();
  for (Eigen::Index j = 0; j < source.cols(); ++j)
    for (Eigen::Index i = 0; i < source.rows(); ++i) elements[i + j * source.rows()] = source(i, j).scalar();
  return result;
}

Matrix to_eigen(const SX& source);

struct Moving;

/// A model whose numbers are constants of the graph, or partly symbols of it.
///
/// With `parametric`, inertial parameters and the translations of the joint placements (3 x njoints) are symbols. The
/// former (10 x njoints) are Pinocchio's dynamic parameters m, m c, I about the joint origin. Column 0 belongs to the
/// universe and is not used.
struct SymbolicModel {
  SymbolicModel(Tree tree, bool parametric);

  Tree tree;
  bool parametric;
  SX inertias;
  SX translations;
  /// The motion of all joints, built for the first frame (frames.cpp).
  mutable std::shared_ptr<const Moving> moving;
};

/// One function being built: its inputs are symbols in the order of the calls, its outputs expressions of them.
class Graph {
 public:
  explicit Graph(const SymbolicModel& symbolic) : symbolic_(symbolic) {}

  Vector input(const std::string& name, Eigen::Index rows);
  Matrix input(const std::string& name, Eigen::Index rows, Eigen::Index columns);
  /// Symbols of expressions that exist already.
  void input(const std::string& name, const SX& symbols);

  template <typename Derived>
  void output(const std::string& name, const Eigen::MatrixBase<Derived>& expression) {
    output(name, to_casadi(expression));
  }
  void output(const std::string& name, const SX& expression);

  /// The casadi::Function as casadi serialises it; symbolic parameters come last among the inputs.
  std::string serialize(const std::string& name) const;

 private:
  const SymbolicModel& symbolic_;
  std::vector<SX> inputs_;
  std::vector<SX> outputs_;
  std::vector<std::string> input_names_;
  std::vector<std::string> output_names_;
};

}  // namespace robotraj
