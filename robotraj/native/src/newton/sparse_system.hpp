// Newton's system of a program without stages, factorised as one sparse symmetric matrix.
#pragma once

#include <memory>
#include <vector>

#include "ldl/factors.hpp"
#include "newton_system.hpp"
#include "program/program.hpp"

namespace robotraj::native {

/// Entries in the program's order: rows of the Jacobian one after the other, the upper triangle of the Hessian.
class SparseMatrices final : public NewtonMatrices {
 public:
  /// Of a layout of one stage without states. `groups` numbers columns and rows, once or more; see ldl::tree_of_fewest_products.
  SparseMatrices(const Layout& layout, const Pattern& jacobian, const Pattern& hessian, const std::vector<int>& groups);

  const Pattern& jacobian() const { return jacobian_; }
  const Pattern& hessian() const { return hessian_; }
  const std::vector<int>& groups() const { return groups_; }
  void transposed_times(const StageValues& values, const double* lam, const double* y, double* out) const override;
  std::unique_ptr<NewtonSolver> solver() const override;

 private:
  const Pattern &jacobian_, &hessian_;
  const std::vector<int>& groups_;
};

/// L D L' of
///
///     [ H + D_x + A_b' D_b^-1 A_b    A_e'   A_i' ]
///     [ A_e                         -D_e         ]
///     [ A_i                                 -D_s ]
///
/// where inequalities A_b of few entries, bounds and friction cones above all, are eliminated. The reduced
/// Hessian is positive definite where the matrix has as many negative eigenvalues as rows.
/// Source: Waechter and Biegler, Mathematical Programming 106 (2006), section 3.1.
class SparseSolver final : public NewtonSolver {
 public:
  explicit SparseSolver(const SparseMatrices& matrices);

  Pivots factorise_and_solve(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                             Along* along) override;
  void solve(const StageValues& jacobian, const NewtonSystem& system) override;
  double residual(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                  std::size_t begin, std::size_t end, StageResidual left) override;

 private:
  /// An inequality that is eliminated, and its entries in the Jacobian.
  struct Eliminated {
    int row;                 ///< number among the inequalities
    std::size_t begin, end;  ///< entries
  };

  const SparseMatrices& matrices_;
  std::vector<Eliminated> eliminated_;
  std::vector<std::int32_t> products_;  ///< places of their entries' products, of each with itself and those before it
  std::vector<int> kept_;               ///< inequalities that are rows of the matrix
  std::vector<std::int32_t> diagonal_, of_jacobian_, of_hessian_;  ///< places of entries in the matrix, -1 for none
  Numbers values_, right_;
  std::unique_ptr<ldl::Factors> factors_;
};

}  // namespace robotraj::native
