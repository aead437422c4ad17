// Derivatives of a stage function as tapes.
#pragma once

#include <casadi/core/function.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "differentiate.hpp"
#include "rigid_body/rigid_tree.hpp"
#include "tape.hpp"

namespace robotraj::native {

/// Outputs A(c) v + b(c) that are linear in v.
class LinearPart {
 public:
  LinearPart(Pattern pattern, std::size_t outputs, casadi::Function numbers)
      : pattern_(std::move(pattern)), outputs_(outputs), numbers_(std::move(numbers)) {}

  /// Rows and columns of the nonzeros of A.
  const Pattern& pattern() const { return pattern_; }
  /// Nonzeros of A, then b, at each of `count` points c.
  std::vector<double> at(const double* constants, std::size_t count) const;
  std::size_t constants() const { return numbers_.nnz_in(0); }

 private:
  Pattern pattern_;
  std::size_t outputs_;
  casadi::Function numbers_;
};

/// y = psi(v, c, r) and, where r = RNEA(x) is a robot's torques, x = chi(v, c).
class StageGraph {
 public:
  /// Reads a serialised function (v, c, r) -> y, x of columns.
  explicit StageGraph(const std::string& text);

  std::size_t inputs() const { return v_.numel(); }
  std::size_t constants() const { return c_.numel(); }
  std::size_t torques() const { return r_.numel(); }
  std::size_t outputs() const { return y_.numel(); }
  std::size_t arguments() const { return x_.numel(); }

  /// (v, c, r) -> y, or one of its entries. These and all other tapes are without r where it is empty.
  Tape values() const;
  Tape output(std::size_t which) const;

  /// Nonzeros of dy/dv, then those of dy/dr.
  struct Slopes {
    Tape tape;
    Pattern by_v, by_r;
  };
  Slopes slopes() const;
  Slopes slopes(std::size_t which) const;
  /// d y_i/dv, dense, of a stage without torques.
  Tape gradient(std::size_t which) const;

  /// With l = d(m' y)/dr: (v, c, r, m) -> l, then nonzeros of the lower triangle of d^2(m' y)/dv^2, dl/dv and dl/dr.
  struct Curvature {
    Tape tape;
    Pattern vv, rv, rr;
  };
  Curvature curvature() const;

  /// Where in v every entry of x stands, -1 for zeros; nothing where one is something else.
  std::optional<std::vector<std::int64_t>> places() const;

  /// (v, c) -> x and the nonzeros of dx/dv; (v, c, g) -> nonzeros of the lower triangle of sum_i g_i d^2 x_i/dv^2.
  struct Arguments {
    Tape tape, curved;
    Pattern by_v, curvature;
  };
  Arguments chain() const;

  /// Which outputs are not affine in v, the torques being functions of v.
  std::vector<bool> curved() const;
  /// dy/dv as a matrix, column after column: numbers where they are constant, NaN where they are not.
  std::vector<double> constant_slopes() const;
  LinearPart linear(const std::vector<std::int64_t>& outputs) const;

 private:
  /// A graph of its own for each tape, so that none has to search the nodes of others.
  struct Scalars {
    ScalarGraph graph;
    Nodes v, c, r, y, x;
  };
  /// With torques as an argument where there are any, or else with zeros.
  Scalars scalars(bool with_torques = true) const;
  static Slopes slopes_of(Scalars& scalars, const Nodes& y);
  std::vector<bool> turned() const;

  casadi::Function function_;
  casadi::SX v_, c_, r_, y_, x_;
};

}  // namespace robotraj::native
