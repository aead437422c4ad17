#include "warm_start.hpp"

#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/nlp/dims.hpp>

#include <algorithm>
#include <cmath>

namespace robotraj::native {

namespace {

/// Moves a distance and its multiplier onto distance * multiplier >= mu, at most `room` from the bound.
void onto_path(double& distance, double& multiplier, double mu, double room) {
  const double root = std::sqrt(mu);
  if (distance * multiplier < mu || distance <= 0.0) {
    if (multiplier >= root && multiplier > distance) distance = mu / multiplier;
    else if (distance >= root) multiplier = mu / distance;
    else distance = multiplier = root;
  }
  if (distance > room) distance = room;
}

}  // namespace

Initializer::Initializer(std::shared_ptr<Data> data, std::shared_ptr<fatrop::IpEqMultInitializerBase> multipliers,
                         std::shared_ptr<Program> program, std::shared_ptr<StageNlp> nlp)
    : data_(data),
      program_(std::move(program)),
      nlp_(std::move(nlp)),
      cold_(data, multipliers),
      y_(nlp_->nlp_dims().number_of_variables),
      lam_(nlp_->nlp_dims().number_of_eq_constraints),
      slacks_(nlp_->nlp_dims().number_of_ineq_constraints),
      lower_duals_(nlp_->nlp_dims().number_of_ineq_constraints),
      upper_duals_(nlp_->nlp_dims().number_of_ineq_constraints) {}

void Initializer::initialize() {
  if (!start.lam) {
    cold_.initialize();
    return;
  }
  auto& iterate = data_->current_iterate();
  std::copy_n(start.y, program_->columns(), y_.data());
  iterate.set_primal_x(y_);
  const double scale = nlp_->objective_scale;
  if (program_->rows()) nlp_->rows_to_fatrop(start.lam, lam_.data());
  for (fatrop::Index i = 0; i < lam_.m(); ++i) lam_(i) *= scale;
  iterate.set_dual_eq(lam_);

  const std::size_t count = nlp_->lower.size();
  program_->set_point(start.y);
  const double* rows = program_->row_values().data() + (program_->rows() - count);
  const double* lam = start.lam + (program_->rows() - count);
  const double mu = iterate.mu();
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<fatrop::Index>(i);
    const double lower = iterate.lower_bounds()(k), upper = iterate.upper_bounds()(k);
    double z_lower = scale * (start.lower_duals ? start.lower_duals[i] : std::max(0.0, -lam[i]));
    double z_upper = scale * (start.upper_duals ? start.upper_duals[i] : std::max(0.0, lam[i]));
    double slack = rows[i];
    const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
    const double room = has_lower && has_upper ? 0.5 * (upper - lower) : std::numeric_limits<double>::infinity();
    // The nearer bound moves the slack; the other one's multiplier then follows the distance that is left.
    const bool lower_first = has_lower && (!has_upper || slack - lower <= upper - slack);
    for (const bool is_lower : {lower_first, !lower_first}) {
      if (!(is_lower ? has_lower : has_upper)) continue;
      double distance = is_lower ? slack - lower : upper - slack;
      double& multiplier = is_lower ? z_lower : z_upper;
      if (is_lower == lower_first) {
        onto_path(distance, multiplier, mu, room);
        slack = is_lower ? lower + distance : upper - distance;
      } else {
        multiplier = std::max(multiplier, mu / distance);
      }
    }
    slacks_(k) = slack;
    lower_duals_(k) = z_lower;
    upper_duals_(k) = z_upper;
  }
  iterate.set_primal_s(slacks_);
  iterate.set_dual_bounds_l(lower_duals_);
  iterate.set_dual_bounds_u(upper_duals_);
}

}  // namespace robotraj::native
