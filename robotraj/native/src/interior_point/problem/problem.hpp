// The problem: minimise f(x, s) subject to rows c(x, s) = 0 and bounds on the slacks s.
#pragma once

#include <memory>
#include <vector>

#include "kernels/vector_kernels.hpp"
#include "newton/newton_system.hpp"
#include "program/program.hpp"

namespace robotraj::interior_point {

using native::Layout;
using native::Numbers;
using native::Packs;
using native::StageValues;

/// Divides a block of memory into vectors, each aligned.
class Parts {
 public:
  explicit Parts(Packs& memory) : at_(memory.data()) {}
  double* take(int n) {
    double* here = at_;
    at_ += native::padded(n);
    return here;
  }

 private:
  double* at_;
};

/// A problem in stages. Rows are [dynamics, path equalities, inequalities], of which the last have a slack each.
class Problem {
 public:
  virtual ~Problem() = default;

  const native::NewtonMatrices& matrices() const { return *matrices_; }
  const std::shared_ptr<native::NewtonMatrices>& shared_matrices() const { return matrices_; }
  const Layout& layout() const { return matrices_->layout(); }
  int columns() const { return layout().columns; }
  int rows() const { return layout().rows; }
  /// Whether rows other than dynamics are relaxed by two further slacks each; see `Feasibility`.
  virtual bool elastic() const { return false; }
  int slacks() const { return static_cast<int>(lower.size()); }
  native::Bounds bounds() const { return {lower.data(), upper.data(), slacks()}; }

  virtual double objective(const double* x, const double* s) = 0;
  /// Of the objective.
  virtual void gradient(const double* x, const double* s, double* of_x, double* of_s) = 0;
  virtual void residual(const double* x, const double* s, double* out) = 0;
  /// out += (dc / ds)' lam.
  virtual void add_slack_product(const double* lam, double* out) const = 0;
  virtual void jacobian(const double* x, StageValues& values) = 0;
  /// Of the Lagrangian in x, but for a diagonal that `damping` holds; null where there is none.
  /// `convex`: without the negative curvature of saturations.
  virtual void hessian(const double* x, const double* lam, bool convex, StageValues& values) = 0;
  /// Whether a function saturates.
  virtual bool saturates() const = 0;
  virtual const double* damping() const { return nullptr; }
  /// Called before a function that depends on mu is evaluated.
  virtual void set_barrier(double) {}

  /// Finite bounds of the slacks.
  int bound_count() const { return bound_count_; }
  /// Called after `lower` or `upper` were written.
  void bounds_changed();

  Numbers lower, upper;  ///< bounds of the slacks, infinite where there is none

 protected:
  explicit Problem(std::shared_ptr<native::NewtonMatrices> matrices) : matrices_(std::move(matrices)) {}

  std::shared_ptr<native::NewtonMatrices> matrices_;

 private:
  int bound_count_ = 0;
};

/// A program with its objective scaled; inequality rows are d(x) - s = 0.
class ProgramProblem final : public Problem {
 public:
  /// Throws std::invalid_argument where an entry joins columns of two stages, other than a state with the one before.
  ProgramProblem(std::shared_ptr<native::Program> program, const Layout& layout);

  double objective_scale = 1.0;

  native::Program& program() { return *program_; }
  double objective(const double* x, const double* s) override;
  void gradient(const double* x, const double* s, double* of_x, double* of_s) override;
  void residual(const double* x, const double* s, double* out) override;
  void add_slack_product(const double* lam, double* out) const override;
  void jacobian(const double* x, StageValues& values) override;
  void hessian(const double* x, const double* lam, bool convex, StageValues& values) override;
  bool saturates() const override { return program_->saturates(); }
  /// Without the objective.
  void row_hessian(const double* x, const double* lam, bool convex, StageValues& values);

 private:
  std::shared_ptr<native::Program> program_;
};

}  // namespace robotraj::interior_point
