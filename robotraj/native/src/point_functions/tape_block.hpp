// A stage function made of tapes and, where it has any, a robot's inverse dynamics; no compiler needed.
#pragma once

#include "kernels/packed.hpp"
#include "parallel/pack.hpp"
#include "point_block.hpp"

#include <array>
#include <initializer_list>
#include <memory>
#include <optional>

namespace robotraj::native {

/// A tape of a stage without constants that many blocks have in common. Its v are the entries of the block's (v, c) at
/// `inputs`, and its multipliers, where it takes some, those of m at `multipliers`.
struct Call {
  std::shared_ptr<const Tape> tape;
  std::vector<std::int32_t> inputs, multipliers;
};

/// How one result of a point is computed, in a buffer
///
///     [ 1 | the tape's outputs | d tau/dx | d^2 (l' tau)/dx^2 | (x, dx/dv) | sum_i g_i d^2 x_i/dv^2 | calls | made ]
///
/// whose last part begins at zero and is filled by the products, in their order. The result is a piece of the buffer.
/// Parts that a recipe does not use, or that the torques do not have, are left out. In the Hessian, l are the first
/// outputs of the tape, and g = (d tau/dx)' l.
struct Recipe {
  Tape tape;
  bool jacobian = false;
  bool hessian = false;
  std::size_t made = 0;
  std::size_t result = 1;
  std::size_t results = 0;
  std::vector<Product> products;
  std::vector<Call> calls;

  /// Numbers that the calls give.
  std::size_t called() const;
};

/// Inverse dynamics inside a stage function: tau = RNEA(q, w, a), x = (q, w, a).
///
/// Each entry of x is one of v, or zero where its place is -1. Otherwise a tape computes x from (v, c), followed by the
/// nonzeros of dx/dv. A second tape then gives sum_i g_i d^2 x_i/dv^2 from (v, c, g).
struct Torques {
  RigidTree robot;
  std::vector<std::int32_t> places;
  Tape arguments, curvature;

  std::size_t size() const { return robot.tree().positions() + 2 * robot.tree().rates(); }
};

/// The recipes of a stage function y = fn(v, c) by their `Evaluation`; that of the convex Hessian, which has the entries
/// of the other one, is empty without saturations.
///
/// Tapes take (v, c), then tau where there are torques, then m where it is the Hessian's.
using Recipes = std::array<Recipe, kEvaluations>;

class TapeBlock : public PointBlock {
 public:
  TapeBlock(const PointSizes& sizes, Recipes recipes, std::optional<Torques> torques, const Kernels& kernels);

  void prepare(std::size_t threads) override;
  void evaluate(Evaluation which, const double* v, const double* c, const double* m, double* out,
                ThreadPool& pool) override;
  bool saturates() const override { return !recipes_.back().tape.empty(); }

 private:
  /// Work memory of a thread for a pack of points.
  struct Work {
    Packs v, c, m, x, g, tau, given, tape, buffer, states;
  };

  /// Where the parts of a recipe's buffer begin.
  struct Parts {
    std::size_t jacobian, hessian, arguments, curvature, calls, made, end;
  };

  Parts parts(const Recipe& recipe) const;
  /// Nanoseconds that a pack takes, roughly.
  std::size_t effort(const Recipe& recipe) const;
  void check(const Recipe& recipe, bool multiplied) const;
  void check(const Call& call, bool multiplied) const;
  void run_pack(const Recipe& recipe, Work& work) const;
  void run_tape(const Tape& tape, std::initializer_list<const double*> arguments, Packs& memory, double* result) const;
  void run_calls(const Recipe& recipe, Work& work, double* results) const;
  const double* arguments(Work& work, double* into) const;

  Recipes recipes_;
  std::optional<Torques> torques_;
  const Kernels& kernels_;
  std::vector<Product> weighing_;  // g += d tau/dx l
  std::size_t hessian_numbers_ = 0;
  std::vector<Work> work_;
};

}  // namespace robotraj::native
