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
  /// Of entries that lie within stages, row by row. Throws std::invalid_argument where they come in another order or
  /// there are more than 2^31 numbers.
  StageMatrices(const Layout& layout, const Pattern& jacobian, const Pattern& hessian,
                const RiccatiKernels& run = riccati_kernels_of());

  void fill_jacobian(const Numbers& entries, StageValues& values) const { fill(entries, jacobian_runs_, values); }
  void fill_hessian(const Numbers& entries, StageValues& values) const { fill(entries, hessian_runs_, values); }
  std::vector<std::int32_t> jacobian_places() const override { return places(jacobian_entries_, jacobian_runs_); }
  std::vector<std::int32_t> hessian_places() const override { return places(hessian_entries_, hessian_runs_); }
  StageValues empty_jacobian() const override { return StageValues(jacobian_size_, 0.0); }
  StageValues empty_hessian() const override { return StageValues(hessian_size_, 0.0); }
  std::unique_ptr<NewtonSolver> solver() const override;

  std::size_t count() const { return stages_.size(); }
  const RiccatiKernels& run() const { return run_; }
  /// Either may be null; the view then lacks its matrices.
  StageView view(std::size_t stage, const StageValues* jacobian, const StageValues* hessian) const;

  /// out = alpha y + A x; y may be out.
  void jacobian_times(const StageValues& values, const double* x, double alpha, const double* y, double* out) const;
  void transposed_times(const StageValues& values, const double* lam, double alpha, const double* y,
                        double* out) const override;
  void hessian_times(const StageValues& values, const double* x, double alpha, const double* y, double* out) const;

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
  /// Entries that follow each other in the program as well as here.
  struct Run {
    std::int32_t place, entry, count;
  };
  using Runs = std::vector<Run>;
  struct Entry {
    std::int32_t row, column, entry;
  };

  static void fill(const Numbers& entries, const Runs& runs, StageValues& values);
  static std::vector<std::int32_t> places(std::size_t entries, const Runs& runs);
  static void append(Runs& runs, std::size_t place, std::int32_t entry);
  static int size_of(const RowPattern& rows, int ld);
  RowPattern pattern_of(const std::vector<Entry>& entries, int count, int n, std::size_t first);
  void place_jacobian(const Pattern& pattern);
  void place_hessian(const Pattern& pattern);

  const RiccatiKernels& run_;
  std::vector<Shape> shapes_;
  std::vector<Stage> stages_;
  Runs jacobian_runs_, hessian_runs_;
  std::size_t jacobian_size_ = 0, hessian_size_ = 0, jacobian_entries_, hessian_entries_;
  mutable Packs memory_;
};

}  // namespace robotraj::native
