// The program as fatrop sees it: stages, and the places of every derivative in fatrop's matrices.
#pragma once

#include <fatrop/nlp/dims.hpp>
#include <fatrop/nlp/nlp.hpp>
#include <fatrop/ocp/dims.hpp>
#include <fatrop/ocp/problem_info.hpp>
#include <fatrop/ocp/type.hpp>

#include <cstdint>
#include <memory>
#include <vector>

#include "program.hpp"
#include "stage_parts.hpp"

namespace robotraj::native {

/// Numbers of controls, states, path equalities and inequalities at every stage.
struct Stages {
  std::vector<fatrop::Index> controls, states, equalities, inequalities;
};

/// fatrop's interface to a Program.
///
/// Columns are fatrop's: (u_0, x_0, u_1, x_1, ...). The program's rows are [dynamics, path equalities, inequalities],
/// each stage after stage, with -x_{k+1} + F(x_k, u_k) in the dynamics; fatrop keeps its path equalities first.
/// One call evaluates every stage, so that the threads share all points at once.
class StageNlp : public fatrop::Nlp<fatrop::OcpType> {
 public:
  using Info = fatrop::ProblemInfo<fatrop::OcpType>;
  using Vector = fatrop::VecRealView;

  /// Throws std::invalid_argument where an entry joins columns of two stages, other than a state with the one before.
  StageNlp(std::shared_ptr<Program> program, const Stages& stages);

  const Info& info() const { return info_; }

  /// Who solves the linear systems; null where fatrop does, with dense matrices.
  StageParts* parts() const { return parts_.get(); }

  /// What the next solve starts from and its bounds of the inequality rows.
  Numbers start, lower, upper;
  /// What fatrop's objective, and so its multipliers, are multiples of.
  double objective_scale = 1.0;
  /// Set before every iteration of the main algorithm.
  bool iterating = false;

  /// Copies row numbers from fatrop's order into the program's, or back.
  void rows_from_fatrop(const double* fatrop, double* program) const;
  void rows_to_fatrop(const double* program, double* fatrop) const;

  const fatrop::NlpDims& nlp_dims() const override { return nlp_dims_; }
  const fatrop::ProblemDims<fatrop::OcpType>& problem_dims() const override { return info_.dims; }
  fatrop::Index eval_lag_hess(const Info& info, fatrop::Scalar factor, const Vector& primal_x,
                              const Vector& primal_s, const Vector& lam,
                              fatrop::Hessian<fatrop::OcpType>& hess) override;
  fatrop::Index eval_constr_jac(const Info& info, const Vector& primal_x, const Vector& primal_s,
                                fatrop::Jacobian<fatrop::OcpType>& jac) override;
  fatrop::Index eval_constraint_violation(const Info& info, const Vector& primal_x, const Vector& primal_s,
                                          Vector& res) override;
  fatrop::Index eval_objective_gradient(const Info& info, fatrop::Scalar factor, const Vector& primal_x,
                                        const Vector& primal_s, Vector& grad_x, Vector& grad_s) override;
  fatrop::Index eval_objective(const Info& info, fatrop::Scalar factor, const Vector& primal_x,
                               const Vector& primal_s, fatrop::Scalar& res) override;
  fatrop::Index get_bounds(const Info& info, Vector& lower_bounds, Vector& upper_bounds) override;
  fatrop::Index get_initial_primal(const Info& info, Vector& primal_x) override;
  void get_primal_damping(const Info& info, Vector& damping) override;
  void callback(const fatrop::IpData<fatrop::OcpType>&) override { iterating = true; }
  void apply_jacobian_s_transpose(const Info& info, const Vector& multipliers, fatrop::Scalar alpha, const Vector& y,
                                  Vector& out) override;

 private:
  /// An entry's place in one of fatrop's matrices, as a distance from the first number of it.
  struct Slot {
    std::int32_t place;
    std::int32_t entry;
  };
  /// The slots of one matrix; none where `parts` has the matrices.
  using Slots = std::vector<Slot>;

  void place_jacobian(bool dense);
  void place_hessian(bool dense);
  std::size_t stage_of(std::size_t column) const;

  std::shared_ptr<Program> program_;
  Info info_;
  std::unique_ptr<StageParts> parts_;
  fatrop::NlpDims nlp_dims_;
  std::size_t n_dynamics_, n_path_, n_slack_;
  std::vector<std::size_t> stage_of_column_;
  std::vector<Slots> dynamics_, path_, slack_, hessian_;
  Numbers lam_;
};

}  // namespace robotraj::native
