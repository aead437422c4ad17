// Derivatives of scalar graphs, as nodes of the same graph.
#pragma once

#include <optional>
#include <vector>

#include "scalar_graph.hpp"

namespace robotraj::native {

/// Which of the nodes in `order`, operands first, depend on u; for every node of the graph.
std::vector<bool> dependent(const ScalarGraph& graph, const Nodes& order, const Nodes& u);

/// A nonzero of a matrix of derivatives.
struct Derivative {
  Node row, column, node;
};
/// Nonzeros column after column, rows ascending in each.
using Derivatives = std::vector<Derivative>;

/// dy/du of results y and arguments u, forward or backward, whichever takes fewer operations. All others are constants.
Derivatives jacobian(ScalarGraph& graph, const Nodes& y, const Nodes& u);

/// The gradient of sum_i m_i y_i by u, one node for each of u.
Nodes gradient(ScalarGraph& graph, const Nodes& y, const Nodes& m, const Nodes& u);

/// The lower triangle of the second derivatives by u of a function whose gradient is given. Each entry is computed once,
/// from the one or the other of its two places in the matrix, whichever takes fewer operations for all together.
Derivatives hessian(ScalarGraph& graph, const Nodes& gradient, const Nodes& u);

/// The lower triangle of the second derivatives by u of sum_i m_i y_i, without the negative curvature of saturations
/// t = tanh(z). Each adds k dz/du dz/du' to it, with k the second derivative by z alone; here k is at least zero.
/// Nothing where y has no saturations. The entries are those of `exact`, in the same order.
std::optional<Nodes> convexified(ScalarGraph& graph, const Derivatives& exact, const Nodes& y, const Nodes& m,
                                 const Nodes& u);

}  // namespace robotraj::native
