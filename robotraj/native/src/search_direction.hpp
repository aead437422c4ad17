// Newton's step with inertia correction that always ends.
#pragma once

#include <fatrop/common/options.hpp>
#include <fatrop/ip_algorithm/ip_data.hpp>
#include <fatrop/ip_algorithm/ip_search_dir.hpp>
#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/linear_algebra/linear_solver_return_flags.hpp>
#include <fatrop/nlp/dims.hpp>
#include <fatrop/nlp/nlp.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>
#include <fatrop/ocp/type.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace robotraj::native {

/// A step by a linear solver of fatrop's, which takes the residuals' copy for its solution.
template <typename LinearSolver>
class FatropStep {
 public:
  using Iterate = fatrop::IpIterate<fatrop::OcpType>;

  FatropStep(Iterate& iterate, std::shared_ptr<LinearSolver> solver)
      : solver_(std::move(solver)),
        x_(iterate.delta_primal_x().m()),
        s_(iterate.delta_primal_s().m()),
        g_(iterate.delta_dual_eq().m()),
        lower_(iterate.delta_dual_bounds_l().m()),
        upper_(iterate.delta_dual_bounds_u().m()) {}

  void prepare(Iterate& iterate) {
    x_.block(x_.m(), 0) = iterate.dual_infeasibility_x();
    s_.block(s_.m(), 0) = iterate.dual_infeasibility_s();
    g_.block(g_.m(), 0) = iterate.constr_viol();
    lower_.block(lower_.m(), 0) = iterate.relaxed_complementarity_l();
    upper_.block(upper_.m(), 0) = iterate.relaxed_complementarity_u();
  }
  fatrop::LinsolReturnFlag solve(Iterate& iterate) {
    typename LinearSolver::LinearSystemType system(
        iterate.info(), iterate.jacobian(), iterate.hessian(), iterate.Dx(), iterate.De_is_zero(), iterate.De(),
        iterate.delta_lower(), iterate.delta_upper(), iterate.dual_bounds_l(), iterate.dual_bounds_u(), x_, s_, g_,
        lower_, upper_);
    return solver_->solve_in_place(system);
  }
  void accept(Iterate& iterate) {
    iterate.set_delta_primal_x(x_);
    iterate.set_delta_primal_s(s_);
    iterate.set_delta_dual_eq(g_);
    iterate.set_delta_dual_bounds_l(lower_);
    iterate.set_delta_dual_bounds_u(upper_);
  }

 private:
  std::shared_ptr<LinearSolver> solver_;
  fatrop::VecRealAllocated x_, s_, g_, lower_, upper_;
};

/// Solves the primal-dual system, damped by delta_w in the Hessian and by delta_c in the constraints as far as needed.
///
/// delta_w grows while the reduced Hessian is not positive; delta_c is set where constraints depend on each other.
/// fatrop's own search asks again for ever where constraints stay dependent under delta_c; here delta_w takes over, and
/// beyond its largest value, or where it stops growing, the step has failed.
/// Source: Waechter and Biegler, On the implementation of an interior-point filter line-search algorithm for
/// large-scale nonlinear programming, 2006, algorithm IC.
template <typename Step>
class SearchDirection : public fatrop::IpSearchDirBase {
 public:
  using Data = fatrop::IpData<fatrop::OcpType>;

  SearchDirection(std::shared_ptr<Data> data, std::unique_ptr<Step> step)
      : data_(std::move(data)), step_(std::move(step)) {}

  void reset() override { last_delta_w_ = 0.0; }

  void register_options(fatrop::OptionRegistry& registry) override {
    registry.register_option("delta_w0", &SearchDirection::set<&SearchDirection::delta_w0_>, this);
    registry.register_option("delta_wmin", &SearchDirection::set<&SearchDirection::delta_wmin_>, this);
    registry.register_option("kappa_wmin", &SearchDirection::set<&SearchDirection::kappa_wmin_>, this);
    registry.register_option("kappa_wplus", &SearchDirection::set<&SearchDirection::kappa_wplus_>, this);
    registry.register_option("kappa_wplusem", &SearchDirection::set<&SearchDirection::kappa_wplusem_>, this);
    registry.register_option("kappa_c", &SearchDirection::set<&SearchDirection::kappa_c_>, this);
    registry.register_option("delta_c_stripe", &SearchDirection::set<&SearchDirection::delta_c_stripe_>, this);
  }

  fatrop::LinsolReturnFlag compute_search_dir() override {
    using fatrop::LinsolReturnFlag;
    auto& iterate = data_->current_iterate();
    step_->prepare(iterate);
    // Evaluated when first asked for: not while the linear algebra is timed.
    iterate.jacobian();
    iterate.hessian();
    double delta_w = 0.0, delta_c = 0.0;
    for (;;) {
      const double tried_w = delta_w, tried_c = delta_c;
      switch (const LinsolReturnFlag flag = solve(delta_w, delta_c)) {
        case LinsolReturnFlag::INDEFINITE:
          delta_w = larger(delta_w);
          break;
        case LinsolReturnFlag::NOFULL_RANK:
          if (delta_c == 0.0) delta_c = delta_c_stripe_ * std::pow(iterate.mu(), kappa_c_);
          else delta_w = larger(delta_w);
          break;
        case LinsolReturnFlag::UNKNOWN:
        case LinsolReturnFlag::NAN_SOLUTION:
          return flag;
        default:
          accept(delta_w, delta_c);
          return flag;
      }
      // Options may ask for corrections that do not grow, and the same system has the same answer.
      const bool grows = delta_w > tried_w || delta_c > tried_c;
      if (!grows || !(delta_w <= largest_delta_w)) return LinsolReturnFlag::UNKNOWN;
    }
  }

 private:
  static constexpr double largest_delta_w = 1e40;

  template <double SearchDirection::*option>
  void set(const double& value) {
    this->*option = value;
  }

  double larger(double delta_w) const {
    if (delta_w > 0.0) return delta_w * (last_delta_w_ == 0.0 ? kappa_wplusem_ : kappa_wplus_);
    return last_delta_w_ == 0.0 ? delta_w0_ : std::max(delta_wmin_, kappa_wmin_ * last_delta_w_);
  }

  fatrop::LinsolReturnFlag solve(double delta_w, double delta_c) {
    auto& iterate = data_->current_iterate();
    iterate.set_Dx(fatrop::VecRealScalar(iterate.Dx().m(), delta_w) + iterate.primal_damping());
    iterate.set_De(fatrop::VecRealScalar(iterate.De().m(), delta_c));
    iterate.set_De_is_zero(delta_c == 0.0);
    auto& timer = data_->timing_statistics().compute_search_dir;
    timer.start();
    const fatrop::LinsolReturnFlag flag = step_->solve(iterate);
    timer.pause();
    return flag;
  }

  void accept(double delta_w, double delta_c) {
    auto& iterate = data_->current_iterate();
    if (delta_w > 0.0) last_delta_w_ = delta_w;
    step_->accept(iterate);
    iterate.search_dir_info().inertia_correction_primal = delta_w;
    iterate.search_dir_info().inertia_correction_dual = delta_c;
  }

  std::shared_ptr<Data> data_;
  std::unique_ptr<Step> step_;
  double last_delta_w_ = 0.0;
  double delta_w0_ = 1e-4, delta_wmin_ = 1e-20;
  double kappa_wmin_ = 1.0 / 3.0, kappa_wplus_ = 8.0, kappa_wplusem_ = 100.0;
  double kappa_c_ = 0.25, delta_c_stripe_ = 1e-6;
};

}  // namespace robotraj::native
