// The augmented system of a step, solved by the recursion of `riccati.hpp`.
#pragma once

#include <vector>

#include "stage_matrices.hpp"

namespace robotraj::native {

/// Solves a `NewtonSystem` stage after stage from the last one. Rows of a stage become part of its Hessian (A_i, and
/// A_e where D_e is given) or are solved for controls (A_e without D_e). Dynamics cost as many operations as they have
/// entries, for vectors of the states; the rest is dense. Source: Vanroye, Sathya, De Schutter, Decre, FATROP, IROS
/// 2023.
class RiccatiSolver final : public NewtonSolver {
 public:
  explicit RiccatiSolver(const StageMatrices& matrices);

  Pivots factorise_and_solve(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                             Along* along) override;
  void solve(const StageValues& jacobian, const NewtonSystem& system) override;
  double residual(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                  std::size_t begin, std::size_t end, StageResidual left) override;

 private:
  StageVectors vectors(std::size_t stage, const NewtonSystem& system) const;
  bool ends_part(std::size_t stage) const {
    return stage + 1 == matrices_.count() || (stage + 1) % Along::at_a_time == 0;
  }
  StageFactor* next(std::size_t stage) { return stage + 1 < factors_.size() ? &factors_[stage + 1] : nullptr; }
  StageFactor make_factor(int nu, int nx, double*& at) const;
  void make_room(std::size_t index, StageFactor& factor, int most);
  void forward(const StageValues& jacobian, const NewtonSystem& system, Along* along);

  const StageMatrices& matrices_;
  const RiccatiKernels& run_;
  std::vector<StageFactor> factors_;
  StageFactor start_;
  Packs block_;                      // of all factors
  std::vector<Packs> eliminations_;  // of the stages that have constraints, the first state's last
  Packs work_, left_;
  RiccatiMemory memory_;
};

}  // namespace robotraj::native
