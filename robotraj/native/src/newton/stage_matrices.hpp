// Hessians and Jacobians of a stagewise program without their zeros, and their products with vectors.
#pragma once

#include <cstdint>
#include <vector>

#include "newton_system.hpp"
#include "program/program.hpp"

namespace robotraj::native {

/// Where the program's entries stand, stage after stage; stages of equal patterns share them.
class StageMatrices final : public NewtonMatrices {
 public:
  /// Of entries that lie within stages, row by row. Throws std::invalid_argument where they come in another order, one
  /// joins two stages other than a state with the one before, or there are more than 2^31 numbers.
  StageMatrices(const Layout& layout, const Pattern& jacobian, const Pattern& hessian,
                const RiccatiKernels& run = riccati_kernels_of());

  std::unique_ptr<NewtonSolver> solver() const override;

  std::size_t count() const { return stages_.size(); }
  const RiccatiKernels& run() const { return run_; }
  /// Either may be null; the view then lacks its matrices.
  StageView view(std::size_t stage, const StageValues* jacobian, const StageValues* hessian) const;

  void transposed_times(const StageValues& values, const double* lam, const double* y, double* out) const override;

 private:
  /// One matrix of a stage: wide rows first, then thin ones.
  struct RowPattern {
    std::vector<std::int32_t> wide, thin, starts, columns;
    bool operator==(const RowPattern& other) const;
  };
  struct Shape {
    int nu, nx, next, equality_count, inequality_count;
    RowPattern dynamics, equalities, inequalities;
    bool operator==(const Shape& other) const;
  };
  struct Stage {
    std::size_t shape, jacobian, hessian;  // the latter two where its values begin
  };
  struct Entry {
    std::int32_t row, column, entry;
  };

  static int size_of(const RowPattern& rows, int ld);
  RowPattern pattern_of(const std::vector<Entry>& entries, int count, int n, std::size_t first);
  void place_jacobian(const Pattern& pattern);
  void place_hessian(const Pattern& pattern);

  const RiccatiKernels& run_;
  std::vector<Shape> shapes_;
  std::vector<Stage> stages_;
  mutable Packs memory_;
};

}  // namespace robotraj::native
