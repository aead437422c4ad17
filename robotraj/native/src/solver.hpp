// fatrop's interior-point algorithm on a stagewise program, put together from its own parts.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "program.hpp"
#include "stage_nlp.hpp"

namespace robotraj::native {

/// fatrop's options by its own names.
using Option = std::variant<bool, int, double, std::string>;
using Options = std::map<std::string, Option>;

/// Where a solve starts. Without `lam` the multipliers are fatrop's own first guess.
struct Start {
  const double* y = nullptr;
  const double* lower = nullptr;         // of the inequality rows
  const double* upper = nullptr;
  const double* lam = nullptr;           // of all rows, in the program's order
  const double* lower_duals = nullptr;   // of the inequality rows' bounds, both non-negative;
  const double* upper_duals = nullptr;   //   without them they are the negative and the positive part of lam
  double mu = 0.0;                       // barrier parameter, 0 for fatrop's option mu_init
  double objective_scale = 1.0;          // what the solver multiplies the objective by; multipliers are of it as it is
};

/// One line of the iteration log: objective, largest violated equality, largest dual infeasibility, barrier parameter.
using Iteration = std::array<double, 4>;

struct Outcome {
  Numbers y;
  Numbers lam;  // gradient + Jacobian' lam = 0 at a solution
  Numbers lower_duals, upper_duals;
  std::string status;
  std::string message;  // what fatrop said where status is "failed"
  int iterations = 0;
  double objective = 0.0;
  double violation = 0.0;  // largest violated row, bounds of inequality rows included
  double mu = 0.0;  // of the scaled objective
  double functions = 0.0, combinations = 0.0, linear_algebra = 0.0, total = 0.0;  // seconds
  std::vector<Iteration> trace;
};

/// Thrown by a check of `Solver::solve` to end it; the last iterate is kept.
struct Stop {
  const char* status;
};

/// A solver of one program, reused by every solve of it: no memory is taken once the first one has ended, but for the
/// restoration phase, which is made when a solve first enters it.
class Solver {
 public:
  Solver(std::shared_ptr<Program> program, const Stages& stages);
  ~Solver();

  const StageNlp& nlp() const { return *nlp_; }

  /// Names of fatrop's options.
  std::vector<std::string> option_names() const;

  /// `check` is called once an iteration, with its number, objective and infeasibility; it ends the solve by throwing
  /// Stop.
  /// Throws std::invalid_argument for an unknown option or one of the wrong type.
  Outcome solve(const Start& start, const Options& options, const std::function<void(int, double, double)>& check);

 private:
  struct Algorithm;

  std::unique_ptr<Algorithm> make() const;
  void set_options(const Options& options);
  void collect(Outcome& outcome);

  std::shared_ptr<Program> program_;
  std::shared_ptr<StageNlp> nlp_;
  std::unique_ptr<Algorithm> algorithm_;
  Options options_;
};

}  // namespace robotraj::native
