// A point function y = fn(v, c) and its exact derivatives, evaluated at many points in one call.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

#include "parallel/thread_pool.hpp"

namespace robotraj::native {

/// Sizes of a block: E points, and per point the inputs, the outputs and the nonzeros of the derivatives.
struct PointSizes {
  std::size_t count = 0;       ///< E, the number of points
  std::size_t inputs = 0;      ///< n_v
  std::size_t constants = 0;   ///< n_c
  std::size_t outputs = 0;     ///< n_y
  std::size_t jacobian = 0;    ///< nonzeros of dy/dv, 0 where the block has none
  std::size_t hessian = 0;     ///< nonzeros of one triangle of d^2(m' y)/dv^2, 0 where the block has none
  std::ptrdiff_t costed = -1;  ///< the output that carries cost, -1 if none does
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

  /// y (n_y, E) at v (n_v, E) with the constants c (n_c, E).
  virtual void values(const double* v, const double* c, double* y, ThreadPool& pool) = 0;
  /// Nonzeros (jacobian, E) of dy/dv.
  virtual void jacobian(const double* v, const double* c, double* nonzeros, ThreadPool& pool) = 0;
  /// The costed output (E,). Called only where `sizes().costed >= 0`, as is `gradient`.
  virtual void cost(const double* v, const double* c, double* cost, ThreadPool& pool) = 0;
  /// Gradient (n_v, E) of the costed output.
  virtual void gradient(const double* v, const double* c, double* gradient, ThreadPool& pool) = 0;
  /// Nonzeros (hessian, E) of one triangle of sum_i m_i d^2 y_i/dv^2, with m (n_y, E).
  virtual void hessian(const double* v, const double* c, const double* m, double* nonzeros, ThreadPool& pool) = 0;
  /// Whether the function saturates: the Hessian without the negative curvature of saturations then differs.
  virtual bool saturates() const { return false; }
  virtual void convex_hessian(const double* v, const double* c, const double* m, double* nonzeros, ThreadPool& pool) {
    hessian(v, c, m, nonzeros, pool);
  }

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
