// The linear system of a Newton step whose slacks are eliminated, and the matrices that it is made of.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "parallel/pack.hpp"
#include "program/stages.hpp"
#include "riccati/riccati.hpp"

namespace robotraj::native {

/// Values of one Jacobian or Hessian, of all stages in one block.
using StageValues = Packs;

/// Diagonals and right-hand sides of
///
///     [ H + D_x  A_e'   A_d'  A_i' ] [ z        ]     [ f   ]
///     [ A_e     -D_e               ] [ lambda_e ] = - [ g_e ]
///     [ A_d                        ] [ lambda_d ]     [ g_d ]
///     [ A_i                  -D_s  ] [ lambda_i ]     [ g_i ]
///
/// with the rows of dynamics, path equalities and inequalities; `g` holds the first two, `de` may be null.
struct NewtonSystem {
  const double *dx, *de, *ds, *f, *g, *inequalities;
  double *z, *lam;
};

/// Work on the slacks of some stages, done while their numbers are in the processor's caches.
class Along {
 public:
  /// Stages from a multiple of it on, or fewer at the end.
  static constexpr std::size_t at_a_time = 16;

  virtual ~Along() = default;
  /// Stages [begin, end) are about to be factorised, the last ones first; where that fails, `after` is not called.
  virtual void before(std::size_t begin, std::size_t end) = 0;
  /// Stages [begin, end) are solved, and so are the states of stage `end`.
  virtual void after(std::size_t begin, std::size_t end) = 0;
};

/// Factorises and solves systems of one pattern, one after the other.
class NewtonSolver {
 public:
  virtual ~NewtonSolver() = default;

  RiccatiOptions options;

  virtual Pivots factorise_and_solve(const StageValues& jacobian, const StageValues& hessian,
                                     const NewtonSystem& system, Along* along) = 0;
  /// Solves with the factors of the last call of `factorise_and_solve`.
  virtual void solve(const StageValues& jacobian, const NewtonSystem& system) = 0;
  /// Residual of stages [begin, end), one after the other in `left`, without the -D_s lambda_i of the inequalities.
  /// Returns its largest magnitude over the other equations.
  virtual double residual(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                          std::size_t begin, std::size_t end, StageResidual left) = 0;
};

/// Where the entries of a program's Jacobian and Hessian stand.
class NewtonMatrices {
 public:
  explicit NewtonMatrices(const Layout& layout) : layout_(layout) {}
  virtual ~NewtonMatrices() = default;

  const Layout& layout() const { return layout_; }
  StageValues empty_jacobian() const { return StageValues(jacobian_size_, 0.0); }
  StageValues empty_hessian() const { return StageValues(hessian_size_, 0.0); }
  /// out = y + A' lam; y may be out.
  virtual void transposed_times(const StageValues& values, const double* lam, const double* y, double* out) const = 0;
  virtual std::unique_ptr<NewtonSolver> solver() const = 0;

  /// Place of each entry of the program among the values, for the program to take over; -1 for entries that are not
  /// stored, such as the -1 of a next state.
  std::vector<std::int32_t> jacobian_places, hessian_places;

 protected:
  const Layout& layout_;
  std::size_t jacobian_size_ = 0, hessian_size_ = 0;
};

}  // namespace robotraj::native
