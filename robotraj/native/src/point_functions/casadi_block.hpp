// A point block whose functions are CasADi's: its virtual machine, or compiled code behind it.
#pragma once

#include <casadi/core/function.hpp>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "point_block.hpp"

namespace robotraj::native {

/// One CasADi function of points, called for `batch` points at a time with memory of its own for every thread.
class PointFunction {
 public:
  PointFunction() = default;
  /// `arguments` are the numbers a point that each argument takes, `results` the numbers a point of the result.
  PointFunction(const std::string& name, const std::string& text, std::size_t batch,
                const std::vector<std::size_t>& arguments, std::size_t results);

  void prepare(std::size_t threads);
  /// Evaluates at `count` points; where the function fails or throws, its results are NaN.
  void evaluate(std::size_t count, const double* const* arguments, double* result, ThreadPool& pool);

 private:
  struct Memory {
    int handle;
    std::vector<const double*> arguments;
    std::vector<double*> results;
    std::vector<casadi_int> integers;
    std::vector<double> reals;
    std::vector<double> tail;  // arguments, then the result, of a call that is filled up
  };
  void call(Memory& memory, double* result) const;

  casadi::Function function_;
  std::size_t batch_ = 1;
  std::vector<std::size_t> widths_;
  std::size_t results_ = 0;
  std::vector<Memory> memories_;
};

/// A point block over CasADi functions, handed over as `Function.serialize()` text.
class CasadiBlock : public PointBlock {
 public:
  /// Name of an evaluation -> the function's text and the points a call of it takes.
  using Functions = std::map<std::string, std::pair<std::string, std::size_t>>;

  /// `functions` holds any of "values", "jacobian", "cost", "gradient" and "hessian". Each takes v and c, the last one
  /// m too, as dense matrices of `batch` columns. It returns one dense matrix with as many columns. Throws
  /// std::invalid_argument where a function's shape is not that.
  CasadiBlock(const PointSizes& sizes, const Functions& functions);

  void prepare(std::size_t threads) override;
  void evaluate(Evaluation which, const double* v, const double* c, const double* m, double* out,
                ThreadPool& pool) override;

 private:
  std::array<PointFunction, 5> functions_;  ///< by their `Evaluation`
};

}  // namespace robotraj::native
