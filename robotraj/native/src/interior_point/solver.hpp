// A program's solver: one solve after the other, in the same memory.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "algorithm.hpp"
#include "interior_point/problem/options.hpp"
#include "restoration.hpp"

namespace robotraj::interior_point {

/// Where a solve starts. Without `lam` its multipliers are estimated, from those of the bounds where these are given.
struct Start {
  const double* y = nullptr;
  const double* lower = nullptr;  // of the inequality rows
  const double* upper = nullptr;
  const double* lam = nullptr;          // of all rows
  const double* lower_duals = nullptr;  // of the inequality rows' bounds, both non-negative;
  const double* upper_duals = nullptr;  //   without them they are the negative and the positive part of lam
  double objective_scale = 1.0;         // factor of the objective; multipliers are those of the unscaled one
};

struct Outcome {
  Numbers y;
  Numbers lam;  // gradient + Jacobian' lam = 0 at a solution
  Numbers lower_duals, upper_duals;
  std::string status;
  std::string message;  // of the exception, where status is "failed"
  int iterations = 0;
  double objective = 0.0;
  double violation = 0.0;  // largest violated row, bounds of inequality rows included
  double mu = 0.0;         // of the scaled objective
  double functions = 0.0, combinations = 0.0, linear_algebra = 0.0, total = 0.0;  // seconds
  std::vector<Iteration> trace;
};

/// Thrown by a check of `Solver::solve` to end it; the last iterate is kept.
struct Stop {
  const char* status;
};

/// A solver of one program. No memory is taken once its first solve has ended. The restoration phase alone is made when
/// a solve first enters it.
class Solver {
 public:
  Solver(std::shared_ptr<native::Program> program, native::Stages stages);
  ~Solver();

  int slacks() const { return problem_.slacks(); }

  /// `check` is called once an iteration, with its number, objective and infeasibility; it ends the solve by throwing
  /// Stop.
  Outcome solve(const Start& start, const Options& options, std::function<void(int, double, double)> check);
  /// The last iterate: of the solve under way when called by its `check`.
  Numbers iterate() const;

 private:
  void begin(const Start& start);
  void collect(const Start& start, Outcome& outcome);

  Layout layout_;
  ProgramProblem problem_;
  Options options_;
  Progress progress_;
  Algorithm algorithm_;
  std::unique_ptr<Restoration> restoration_;
};

}  // namespace robotraj::interior_point
