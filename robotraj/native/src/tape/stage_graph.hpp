// Derivatives of a stage function as tapes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "differentiate.hpp"
#include "sparse/pattern.hpp"
#include "tape.hpp"

namespace robotraj::native {

/// y = psi(v, c, r) and, where r = RNEA(x) is a robot's torques, x = chi(v, c).
///
/// A function that calls others has no tapes: those methods throw NotATape.
class StageGraph {
 public:
  /// Reads a serialised function (v, c, r) -> y, x of columns.
  explicit StageGraph(const std::string& text);
  /// The same with some of the outputs.
  StageGraph selected(const std::vector<std::int64_t>& outputs) const;

  std::size_t inputs() const { return v_.size(); }
  std::size_t constants() const { return c_.size(); }
  std::size_t torques() const { return r_.size(); }
  std::size_t outputs() const { return y_.size(); }
  std::size_t arguments() const { return x_.size(); }

  /// (v, c, r) -> y. This and all other tapes are without r where it is empty.
  Tape values() const;
  /// The nonzeros of dy/dv, then those of dy/dr; and where both are.
  std::tuple<Tape, Pattern, Pattern> slopes() const;
  /// The gradient by v of the only output, dense, of a stage without torques.
  Tape gradient() const;

  /// With l = d(m' y)/dr: (v, c, r, m) -> l, then nonzeros of the lower triangle of d^2(m' y)/dv^2, dl/dv and dl/dr; the
  /// same without negative curvature of saturations (`convexified`), nothing without saturations; and the three patterns.
  std::tuple<Tape, std::optional<Tape>, Pattern, Pattern, Pattern> curvature() const;

  /// Where in v every entry of x stands, -1 for zeros; nothing where one is something else.
  std::optional<std::vector<std::int64_t>> places() const;

  /// (v, c) -> x and the nonzeros of dx/dv; (v, c, g) -> nonzeros of the lower triangle of sum_i g_i d^2 x_i/dv^2; and
  /// both patterns.
  std::tuple<Tape, Tape, Pattern, Pattern> chain() const;

  /// The outputs that are not affine in v, the torques and results of calls being functions of v. Of the others, A v + b:
  /// (no v, c) -> the nonzeros of A, then b; and the pattern of A.
  std::tuple<std::vector<std::int64_t>, Tape, Pattern> split() const;
  /// dy/dv as a matrix, column after column: numbers where they are constant, NaN where they are not.
  std::vector<double> constant_slopes() const;

 private:
  StageGraph() = default;
  /// The graph, to which derivatives are added. Each tape has its own copy, so that none has to search the nodes of
  /// others. Throws NotATape where the function calls others.
  ScalarGraph scalars() const;
  /// v, then r and the results of calls, which are functions of v.
  Nodes moving() const;

  ScalarGraph graph_;
  Nodes v_, c_, r_, y_, x_, called_;
};

}  // namespace robotraj::native
