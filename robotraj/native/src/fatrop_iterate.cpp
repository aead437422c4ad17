// fatrop's vectors of slacks, bounds and their multipliers, each in one pass.
//
// Definitions of members of fatrop's iterate: in the process before fatrop is, they are what fatrop's calls are bound to.
// Each does what fatrop's own does, to rounding, and leaves the same members behind, so that any of them may be fatrop's
// own; where no solve of ours is under way, they pass on to those. No function of fatrop's may be called by its name
// here: this library is loaded before there is one.
#include <fatrop/ip_algorithm/ip_iterate.hpp>
#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/nlp/dims.hpp>
#include <fatrop/nlp/nlp.hpp>
#include <fatrop/ocp/problem_info.hpp>
#include <fatrop/ocp/type.hpp>

#include <algorithm>
#include <utility>

#include "fatrop_own.hpp"
#include "fatrop_parts.hpp"
#include "vector_kernels.hpp"

namespace {

using Iterate = fatrop::IpIterate<fatrop::OcpType>;
using fatrop::Scalar;
using robotraj::native::Bounds;
using robotraj::native::VectorKernels;
using robotraj::native::original;
using Vector = fatrop::VecRealView;

/// Null where this thread is in no solve of ours.
const VectorKernels* kernels() {
  const auto* parts = *robotraj_fatrop_parts();
  return parts ? &parts->vectors() : nullptr;
}

Bounds bounds_of(const Iterate& iterate) {
  return {iterate.lower_bounds().data(), iterate.upper_bounds().data(), iterate.lower_bounds().m()};
}

}  // namespace

#define MEMBER template <> __attribute__((visibility("default")))
#define NAME(name) "_ZN6fatrop9IpIterateINS_7OcpTypeEE" name
/// Calls fatrop's own member function, of a name that follows the class's, on an iterate.
#define OWN(result, name) original<result (*)(Iterate&)>(NAME(name), __builtin_return_address(0))
#define PASS_ON_WHERE_IDLE(name, function_type, ...)                                             \
  const VectorKernels* const run = kernels();                                                    \
  if (!run) {                                                                                    \
    static const auto own = original<function_type>(NAME(name), __builtin_return_address(0));    \
    return own(__VA_ARGS__);                                                                     \
  }                                                                                              \
  static_assert(true, "")

namespace fatrop {

/// The distances to the bounds as well.
MEMBER Scalar Iterate::barrier_value() {
  PASS_ON_WHERE_IDLE("13barrier_valueEv", Scalar (*)(Iterate&), *this);
  if (barrier_value_evaluated_ && delta_lower_evaluated_ && delta_upper_evaluated_) return barrier_value_;
  const Bounds bounds = bounds_of(*this);
  double *below = delta_lower_.data(), *above = delta_upper_.data();
  const auto sums = run->distances(bounds, primal_s_.data(), below, above);
  barrier_value_ = mu_ * (kappa_d_ * mu_ * sums.single - robotraj::native::log_sum(sums, bounds, below, above));
  delta_lower_evaluated_ = delta_upper_evaluated_ = barrier_value_evaluated_ = true;
  return barrier_value_;
}

MEMBER const Vector& Iterate::delta_lower() {
  PASS_ON_WHERE_IDLE("11delta_lowerEv", const Vector& (*)(Iterate&), *this);
  if (!delta_lower_evaluated_) barrier_value();
  return delta_lower_;
}

MEMBER const Vector& Iterate::delta_upper() {
  PASS_ON_WHERE_IDLE("11delta_upperEv", const Vector& (*)(Iterate&), *this);
  if (!delta_upper_evaluated_) barrier_value();
  return delta_upper_;
}

MEMBER const Vector& Iterate::barrier_gradient() {
  PASS_ON_WHERE_IDLE("16barrier_gradientEv", const Vector& (*)(Iterate&), *this);
  if (!barrier_gradient_evaluated_) {
    run->barrier_gradient(bounds_of(*this), delta_lower().data(), delta_upper().data(), mu_, mu_ * kappa_d_,
                          barrier_gradient_.data());
    barrier_gradient_evaluated_ = true;
  }
  return barrier_gradient_;
}

MEMBER Scalar Iterate::linear_decrease_barrier() {
  PASS_ON_WHERE_IDLE("23linear_decrease_barrierEv", Scalar (*)(Iterate&), *this);
  if (!linear_decrease_barrier_evaluated_) {
    linear_decrease_barrier_ = run->barrier_slope(bounds_of(*this), delta_lower().data(), delta_upper().data(), mu_,
                                                  mu_ * kappa_d_, delta_primal_s_.data());
    linear_decrease_barrier_evaluated_ = true;
  }
  return linear_decrease_barrier_;
}

MEMBER const Vector& Iterate::relaxed_complementarity_l(const Scalar mu) {
  PASS_ON_WHERE_IDLE("25relaxed_complementarity_lEd", const Vector& (*)(Iterate&, Scalar), *this, mu);
  run->complementarity(lower_bounds_->data(), dual_bounds_l_.data(), delta_lower().data(), mu, dual_bounds_l_.m(),
                       relaxed_complementarity_l_.data());
  return relaxed_complementarity_l_;
}

MEMBER const Vector& Iterate::relaxed_complementarity_u(const Scalar mu) {
  PASS_ON_WHERE_IDLE("25relaxed_complementarity_uEd", const Vector& (*)(Iterate&, Scalar), *this, mu);
  run->complementarity(upper_bounds_->data(), dual_bounds_u_.data(), delta_upper().data(), mu, dual_bounds_u_.m(),
                       relaxed_complementarity_u_.data());
  return relaxed_complementarity_u_;
}

MEMBER void Iterate::update_dual_l1_norms() {
  PASS_ON_WHERE_IDLE("20update_dual_l1_normsEv", void (*)(Iterate&), *this);
  if (dual_l1_norms_evaluated_) return;
  dual_bounds_l1_ = run->absolute_sum(dual_bounds_l_.data(), dual_bounds_l_.m()) +
                    run->absolute_sum(dual_bounds_u_.data(), dual_bounds_u_.m());
  dual_eq_l1_ = run->absolute_sum(dual_eq_.data(), dual_eq_.m());
  dual_l1_norms_evaluated_ = true;
}

/// Waechter and Biegler 2006, equation 5; the means of the multipliers scale what is above `smax`.
MEMBER Scalar Iterate::e_mu(Scalar mu) {
  PASS_ON_WHERE_IDLE("4e_muEd", Scalar (*)(Iterate&, Scalar), *this, mu);
  static const auto violation = OWN(Scalar, "15constr_viol_infEv");
  static const auto infeasibility_x = OWN(Scalar, "24dual_infeasibility_x_infEv");
  static const auto infeasibility_s = OWN(Scalar, "24dual_infeasibility_s_infEv");
  update_dual_l1_norms();
  const Scalar bound_count = *number_of_bounds_;
  const Scalar mean = (dual_bounds_l1_ + dual_eq_l1_) / (bound_count + dual_eq_.m());
  const Scalar mean_bounds = dual_bounds_l1_ / bound_count;
  Scalar dual = std::max(infeasibility_x(*this), infeasibility_s(*this));
  if (mean > smax_) dual /= mean / smax_;
  Scalar complementarity =
      run->largest_complementarity(bounds_of(*this), dual_bounds_l_.data(), delta_lower().data(),
                                   dual_bounds_u_.data(), delta_upper().data(), mu);
  if (mean_bounds > smax_) complementarity /= mean_bounds / smax_;
  return std::max({violation(*this), dual, complementarity});
}

MEMBER Scalar Iterate::maximum_step_size_primal(const Scalar tau, const Vector& delta_s) {
  PASS_ON_WHERE_IDLE("24maximum_step_size_primalEdRKNS_11VecRealViewE", Scalar (*)(Iterate&, Scalar, const Vector&),
                     *this, tau, delta_s);
  return run->longest_step(bounds_of(*this), delta_lower().data(), delta_upper().data(), delta_s.data(), tau);
}

MEMBER Scalar Iterate::maximum_step_size_dual(const Scalar tau, const Vector& lower, const Vector& upper) {
  PASS_ON_WHERE_IDLE("22maximum_step_size_dualEdRKNS_11VecRealViewES5_",
                     Scalar (*)(Iterate&, Scalar, const Vector&, const Vector&), *this, tau, lower, upper);
  return run->longest_dual_step(bounds_of(*this), dual_bounds_l_.data(), lower.data(), dual_bounds_u_.data(),
                                upper.data(), tau);
}

MEMBER void Iterate::modify_dual_bounds(Scalar mu) {
  PASS_ON_WHERE_IDLE("18modify_dual_boundsEd", void (*)(Iterate&, Scalar), *this, mu);
  complementarity_l_evaluated_ = complementarity_u_evaluated_ = false;
  dual_infeasibility_s_evaluated_ = dual_l1_norms_evaluated_ = false;
  run->clamp_duals(lower_bounds_->data(), delta_lower().data(), mu, kappa_sigma_, dual_bounds_l_.m(),
                   dual_bounds_l_.data());
  run->clamp_duals(upper_bounds_->data(), delta_upper().data(), mu, kappa_sigma_, dual_bounds_u_.m(),
                   dual_bounds_u_.data());
}

}  // namespace fatrop
