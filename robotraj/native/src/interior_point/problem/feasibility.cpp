#include "feasibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robotraj::interior_point {

Feasibility::Feasibility(ProgramProblem& original) : Problem(original.shared_matrices()), original_(original) {
  const int count = layout().slacks + 2 * relaxed();
  lower.assign(count, 0.0);
  upper.assign(count, std::numeric_limits<double>::infinity());
  for (Numbers* each : {&reference_, &weights_, &damping_}) each->resize(columns());
}

void Feasibility::start_from(const double* x) {
  std::copy(original_.lower.begin(), original_.lower.end(), lower.begin());
  std::copy(original_.upper.begin(), original_.upper.end(), upper.begin());
  bounds_changed();
  reference_.assign(x, x + columns());
  for (std::size_t i = 0; i < reference_.size(); ++i) {
    const double size = std::max(1.0, std::abs(reference_[i]));
    weights_[i] = 1.0 / (size * size);
  }
}

void Feasibility::set_barrier(double mu) {
  for (std::size_t i = 0; i < weights_.size(); ++i) damping_[i] = std::sqrt(mu) * weights_[i];
}

double Feasibility::objective(const double* x, const double* s) {
  double sum = 0.0, distance = 0.0;
  for (int i = first_p(); i < slacks(); ++i) sum += s[i];
  for (std::size_t i = 0; i < reference_.size(); ++i)
    distance += damping_[i] * (x[i] - reference_[i]) * (x[i] - reference_[i]);
  return rho * sum + 0.5 * distance;
}

void Feasibility::gradient(const double* x, const double*, double* of_x, double* of_s) {
  for (std::size_t i = 0; i < reference_.size(); ++i) of_x[i] = damping_[i] * (x[i] - reference_[i]);
  std::fill_n(of_s, first_p(), 0.0);
  std::fill(of_s + first_p(), of_s + slacks(), rho);
}

void Feasibility::residual(const double* x, const double* s, double* out) {
  original_.residual(x, s, out);
  double* row = out + layout().equality_rows;
  for (int i = 0; i < relaxed(); ++i) row[i] += s[first_n() + i] - s[first_p() + i];
}

void Feasibility::add_slack_product(const double* lam, double* out) const {
  original_.add_slack_product(lam, out);
  const double* of_row = lam + layout().equality_rows;
  for (int i = 0; i < relaxed(); ++i) {
    out[first_p() + i] -= of_row[i];
    out[first_n() + i] += of_row[i];
  }
}

}  // namespace robotraj::interior_point
