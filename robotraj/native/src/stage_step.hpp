// Newton's step of the whole primal-dual system, by the recursion over stages and passes over the slacks.
#pragma once

#include <fatrop/ip_algorithm/ip_iterate.hpp>
#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/linear_algebra/linear_solver_return_flags.hpp>
#include <fatrop/nlp/dims.hpp>
#include <fatrop/nlp/nlp.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>
#include <fatrop/ocp/type.hpp>

#include "stage_parts.hpp"

namespace robotraj::native {

/// Finds the step of an iterate in the iterate's own vectors, from its own residuals: nothing is copied.
///
/// The multipliers of the bounds and the slacks are eliminated, stages solved, and the solution refined as long as the
/// residual falls and is above 1e-8 and a small part of the right-hand side b: 1e-6 of a large one, 1e-7 below 1.
/// Newton's method converges as fast with steps that leave a small part of b (Dembo, Eisenstat and Steihaug, SIAM J.
/// Numer. Anal. 19, 1982). Residuals are measured some stages at a time and kept where a solution is to be refined.
class StageStep : private Along {
 public:
  using Iterate = fatrop::IpIterate<fatrop::OcpType>;

  explicit StageStep(StageParts& parts);

  void prepare(Iterate& iterate);
  /// With the iterate's Dx and De.
  fatrop::LinsolReturnFlag solve(Iterate& iterate);
  void accept(Iterate& iterate);

 private:
  /// A right-hand side or a solution: primal variables, rows' multipliers, slacks, multipliers of their bounds.
  struct Step {
    double *x, *rows, *s, *lower, *upper;
  };
  struct Side {
    const double *x, *rows, *s, *lower, *upper;
  };
  /// What a solution leaves of some stages, one after the other.
  struct Left {
    StageResidual stages;
    SlackStep slacks;
  };

  static Side of(const Step& step) { return {step.x, step.rows, step.s, step.lower, step.upper}; }
  Step take(double*& at) const;
  Left whole(const Step& step) const;
  void make_part();
  void make_refinement();
  /// The first slack of a stage, and the end of all of them behind the last one.
  int first_slack(std::size_t stage) const;
  RiccatiSolver::System system(Iterate& iterate, const Side& side, const double* weights, const Step& step) const;
  /// From slack number `first` on.
  SlackSystem slacks(const Iterate& iterate, int first) const;
  // All of them for stages [begin, end).
  void reduce(const Iterate& iterate, const Side& side, std::size_t begin, std::size_t end);
  void recover(const Iterate& iterate, const Side& side, const Step& step, std::size_t begin, std::size_t end) const;
  double residual(Iterate& iterate, const Step& step, std::size_t begin, std::size_t end, const Left& left);
  void before(std::size_t begin, std::size_t end) override { reduce(*solved_, side_, begin, end); }
  void after(std::size_t begin, std::size_t end) override;

  fatrop::LinsolReturnFlag refine(Iterate& iterate);
  void solve_again(Iterate& iterate, const Side& side, const Step& step);
  bool finite(const Step& step) const;
  void add(const Step& first, const Step& second, const Step& sum) const;

  StageParts& parts_;
  const VectorKernels& run_;
  std::size_t stages_;
  int columns_, rows_, slacks_, first_slack_row_, first_path_row_;
  Packs memory_;
  double *inverse_, *gradient_, *weights_, *slack_rows_;
  Packs part_memory_, refinement_memory_;  // the latter when it is first needed
  Left part_{};
  Step residual_{}, correction_{}, better_{};
  Side side_{};
  double size_ = 0.0;
  // Of what is solved now.
  Iterate* solved_ = nullptr;
  Step step_{};
  double left_ = 0.0;
};

}  // namespace robotraj::native
