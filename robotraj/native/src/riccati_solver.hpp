// The augmented system of a step, solved by the recursion of `riccati.hpp`.
#pragma once

#include <vector>

#include "riccati.hpp"
#include "stage_matrices.hpp"

namespace robotraj::native {

/// What goes along with a solution, for some stages at a time, so that their numbers stay in the caches.
class Along {
 public:
  /// Stages from a multiple of it on, or fewer at the end.
  static constexpr std::size_t at_a_time = 16;

  virtual ~Along() = default;
  /// Stages [begin, end) are about to be factorised, the last ones first; where that fails, `after` is not called.
  virtual void before(std::size_t begin, std::size_t end) = 0;
  /// Those are solved, and the states of stage `end`.
  virtual void after(std::size_t begin, std::size_t end) = 0;
};

/// Solves, for the rows' weights D_e and D_s and the damping D_x,
///
///     [ H + D_x  A_e'   A_d'  A_i' ] [ z        ]     [ f   ]
///     [ A_e     -D_e               ] [ lambda_e ] = - [ g_e ]
///     [ A_d                        ] [ lambda_d ]     [ g_d ]
///     [ A_i                  -D_s  ] [ lambda_i ]     [ g_i ]
///
/// stage after stage from the last one: each stage's rows become part of its Hessian (A_i, and A_e where D_e is given)
/// or are solved for controls (A_e without D_e). Dynamics cost as many operations as they have entries, for vectors of
/// the states; the rest is dense.
/// Source: Vanroye, Sathya, De Schutter, Decre, FATROP, IROS 2023.
class RiccatiSolver {
 public:
  explicit RiccatiSolver(const StageMatrices& matrices);

  RiccatiOptions options;

  /// Diagonals and right-hand sides, those of the inequalities by themselves; `de` may be null.
  struct System {
    const double *dx, *de, *ds, *f, *g, *inequalities;
    double *z, *lam;
  };
  Pivots factorise_and_solve(const StageValues& jacobian, const StageValues& hessian, const System& system,
                             Along* along = nullptr);
  /// With the factors of the last call of the above.
  void solve(const StageValues& jacobian, const System& system);
  /// What z and lam leave of stages [begin, end), one after the other in `left`, without the -D_s lambda_i of the
  /// inequalities. Returns the greatest of it, rows of inequalities left out.
  double residual(const StageValues& jacobian, const StageValues& hessian, const System& system, std::size_t begin,
                  std::size_t end, StageResidual left);

 private:
  StageVectors vectors(std::size_t stage, const System& system) const;
  bool ends_part(std::size_t stage) const {
    return stage + 1 == matrices_.count() || (stage + 1) % Along::at_a_time == 0;
  }
  StageFactor* next(std::size_t stage) { return stage + 1 < factors_.size() ? &factors_[stage + 1] : nullptr; }
  StageFactor make_factor(int nu, int nx, double*& at) const;
  void make_room(std::size_t index, StageFactor& factor, int most);
  void forward(const StageValues& jacobian, const System& system, Along* along);

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
