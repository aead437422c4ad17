// The linear algebra of a solve, done here instead of in fatrop.
#pragma once

#include <fatrop/common/options.hpp>
#include <fatrop/ocp/problem_info.hpp>
#include <fatrop/ocp/type.hpp>

#include <memory>
#include <utility>
#include <vector>

#include "fatrop_parts.hpp"
#include "riccati_solver.hpp"
#include "stage_matrices.hpp"
#include "vector_kernels.hpp"

namespace robotraj::native {

/// Keeps the values of fatrop's Jacobians and Hessians, and answers fatrop's calls for them.
///
/// fatrop keeps three of each (the iterate, the trial and a stored one), dense; those that it makes while these parts are
/// lent to it are as small as can be.
class StageParts final : public FatropParts {
 public:
  using Info = fatrop::ProblemInfo<fatrop::OcpType>;

  /// Whether fatrop's calls arrive here. Not where fatrop was used in this process before `_kernels` was in it.
  static bool take_over();

  StageParts(const Info& info, const Pattern& jacobian, const Pattern& hessian);

  /// Starts afresh for another algorithm, with its options and its matrices.
  void serve(fatrop::OptionRegistry& registry);
  const StageMatrices& matrices() const { return matrices_; }
  /// Zeros for one that is new.
  StageValues& values(Jacobian& jacobian);
  StageValues& values(Hessian& hessian);

  const VectorKernels& vectors() const override { return vectors_; }
  const Dims& made(const Dims&) override { return least_; }
  bool owns(const Jacobian& jacobian) override { return find(jacobians_, &jacobian) != nullptr; }
  bool owns(const Hessian& hessian) override { return find(hessians_, &hessian) != nullptr; }
  void times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y, Vector& out) override;
  void transposed_times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y,
                        Vector& out) override;
  void times(const Hessian& hessian, const Vector& x, double alpha, const Vector& y, Vector& out) override;
  void set_zero(Hessian& hessian) override;
  int solve(const Jacobian& jacobian, Hessian& hessian, const Vector& d_x, const Vector* d_e, const Vector& d_s,
            const Vector& f, const Vector& g, Vector& x, Vector& multipliers) override;
  int solve_again(const Jacobian& jacobian, const Vector* d_e, const Vector& d_s, const Vector& f, const Vector& g,
                  Vector& x, Vector& multipliers) override;

  const Info& info() const { return matrices_.info(); }
  /// The augmented system; a LinsolReturnFlag.
  int solve(const Jacobian& jacobian, Hessian& hessian, const RiccatiSolver::System& system, Along* along);
  /// With the factors of the last one.
  void solve_again(const Jacobian& jacobian, const RiccatiSolver::System& system);
  /// What z and lam leave of it: see RiccatiSolver::residual.
  double residual(const Jacobian& jacobian, Hessian& hessian, const RiccatiSolver::System& system, std::size_t begin,
                  std::size_t end, const StageResidual& left);

  /// While it lives, fatrop's calls from this thread arrive at these parts; null for fatrop's own.
  class Lent {
   public:
    explicit Lent(FatropParts* parts);
    ~Lent();
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;

   private:
    FatropParts* before_;
  };

 private:
  using Owned = std::vector<std::pair<const void*, StageValues>>;

  static StageValues* find(Owned& owned, const void* matrix);
  void set_lu_tolerance(const double& value) { solver_.options.lu_tolerance = value; }
  void set_pivot_tolerance(const double& value) { solver_.options.pivot_tolerance = value; }

  const VectorKernels& vectors_ = vector_kernels_of();
  const Dims least_{1, {0}, {1}, {0}, {0}};
  StageMatrices matrices_;
  RiccatiSolver solver_;
  Owned jacobians_, hessians_;
};

}  // namespace robotraj::native
