// A point function y = fn(v, c) and its exact derivatives, evaluated at many points in one call.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

#include "parallel/thread_pool.hpp"

namespace robotraj::native {

/// What is evaluated at the points, with v (n_v, E), constants c (n_c, E) and, for Hessians, multipliers m (n_y, E).
enum class Evaluation {
  values,          ///< y (n_y, E)
  jacobian,        ///< nonzeros (jacobian, E) of dy/dv
  cost,            ///< the costed output (E,); only where `costed >= 0`, as is the gradient
  gradient,        ///< (n_v, E), of the costed output
  hessian,         ///< nonzeros (hessian, E) of one triangle of sum_i m_i d^2 y_i/dv^2
  convex_hessian,  ///< the same without the negative curvature of saturations
};
constexpr std::size_t kEvaluations = 6;

/// Sizes of a block: E points, and per point the inputs, the outputs and the nonzeros of the derivatives.
struct PointSizes {
  std::size_t count = 0;       ///< E, the number of points
  std::size_t inputs = 0;      ///< n_v
  std::size_t constants = 0;   ///< n_c
  std::size_t outputs = 0;     ///< n_y
  std::size_t jacobian = 0;    ///< nonzeros of dy/dv, 0 where the block has none
  std::size_t hessian = 0;     ///< nonzeros of one triangle of d^2(m' y)/dv^2, 0 where the block has none
  std::ptrdiff_t costed = -1;  ///< the output that carries cost, -1 if none does

  /// Numbers that an evaluation gives at one point.
  std::size_t results(Evaluation which) const {
    const std::size_t numbers[kEvaluations] = {outputs, jacobian, 1, inputs, hessian, hessian};
    return numbers[static_cast<std::size_t>(which)];
  }
};

/// One point function at E points.
///
/// Every array is column-major (n, E): point after point. The order of the nonzeros is the block's own and the
/// same at every point; the constructor returns it to Python. An evaluation writes every entry of its result and
/// allocates nothing. It gives the same bits for any number of threads, and never throws once `prepare` was called. A
/// block has work memory of its own, so it has one caller at a time: `alone` makes the others wait.
class PointBlock {
 public:
  explicit PointBlock(const PointSizes& sizes) : sizes_(sizes) {}
  virtual ~PointBlock() = default;
  PointBlock(const PointBlock&) = delete;
  PointBlock& operator=(const PointBlock&) = delete;

  const PointSizes& sizes() const { return sizes_; }

  /// Makes work memory for this many threads; called before the first evaluation, and again when there are more.
  virtual void prepare(std::size_t threads) = 0;

  /// Writes the results at all points; `m` is null but for Hessians.
  virtual void evaluate(Evaluation which, const double* v, const double* c, const double* m, double* out,
                        ThreadPool& pool) = 0;
  /// Whether the function saturates: its two Hessians then differ.
  virtual bool saturates() const { return false; }

  /// Calls evaluate(pool) with the block's own threads, for callers that have no pool: one after another.
  template <typename Evaluate>
  void alone(std::size_t threads, Evaluate&& evaluate) {
    const std::lock_guard<std::mutex> lock(alone_);
    if (!own_pool_ || own_pool_->size() != threads) own_pool_ = std::make_unique<ThreadPool>(threads);
    prepare(own_pool_->size());
    evaluate(*own_pool_);
  }

 private:
  PointSizes sizes_;
  std::mutex alone_;
  std::unique_ptr<ThreadPool> own_pool_;
};

}  // namespace robotraj::native
