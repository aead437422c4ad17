#include "riccati_solver.hpp"

#include <algorithm>

namespace robotraj::native {

namespace {

std::size_t factor_size(int nu, int nx) {
  const int ld = padded(nu + nx);
  return static_cast<std::size_t>(trapezoid(nu, ld) + 2 * padded(nu) + padded(nx) + trapezoid(nx, padded(nx)));
}

}  // namespace

RiccatiSolver::RiccatiSolver(const StageMatrices& matrices) : matrices_(matrices), run_(matrices.run()), start_{} {
  const Layout& layout = matrices.layout();
  int n = 1, rows = 1;
  std::size_t size = factor_size(layout.states[0], 0);
  for (std::size_t k = 0; k < matrices.count(); ++k) {
    const int nu = layout.controls[k], nx = layout.states[k];
    size += factor_size(nu, nx);
    n = std::max({n, nu + nx, k + 1 < matrices.count() ? layout.states[k + 1] : 0});
    rows = std::max({rows, layout.equalities[k], layout.inequalities[k]});
  }
  block_.resize(size);
  double* at = block_.data();
  for (std::size_t k = 0; k < matrices.count(); ++k)
    factors_.push_back(make_factor(layout.controls[k], layout.states[k], at));
  start_ = make_factor(layout.states[0], 0, at);
  eliminations_.resize(matrices.count() + 1);

  const auto ld = static_cast<std::size_t>(padded(n)), length = static_cast<std::size_t>(padded(std::max(n, rows)));
  // Constraints are at most as many as unknowns; products hold rows of either kind.
  work_.resize(4 * ld * ld + 2 * length * ld + 8 * length);
  left_.resize(length);
  at = work_.data();
  for (double** matrix : {&memory_.matrix, &memory_.reduced, &memory_.cost, &memory_.constraints}) {
    *matrix = at;
    at += ld * ld;
  }
  memory_.first = at;
  memory_.second = at + length * ld;
  memory_.vector = at + 2 * length * ld;
  memory_.length = static_cast<int>(length);
}

StageFactor RiccatiSolver::make_factor(int nu, int nx, double*& at) const {
  StageFactor factor{};
  const auto take = [&at](int count) {
    double* here = at;
    at += count;
    return here;
  };
  factor.l = take(trapezoid(nu, padded(nu + nx)));
  factor.diagonal = take(padded(nu));
  factor.step = take(padded(nu));
  factor.p = take(padded(nx));
  factor.cost = take(trapezoid(nx, padded(nx)));
  factor.nu = nu;
  factor.nx = nx;
  return factor;
}

void RiccatiSolver::make_room(std::size_t index, StageFactor& factor, int most) {
  if (factor.most >= most) return;
  eliminations_[index].resize(elimination_size(most, factor.nu, factor.nx));
  factor.elimination = eliminations_[index].data();
  factor.most = most;
}

StageVectors RiccatiSolver::vectors(std::size_t k, const NewtonSystem& system) const {
  const Layout& layout = matrices_.layout();
  const auto equalities = layout.first_equality[k], inequalities = layout.first_inequality[k];
  const auto dynamics = k + 1 < matrices_.count() ? layout.first_dynamics[k] : 0;
  const auto first = layout.first_column[k];
  return {system.f + first,
          system.g + dynamics,
          system.g + equalities,
          system.inequalities + layout.first_slack[k],
          system.dx ? system.dx + first : nullptr,
          system.de ? system.de + (equalities - layout.equality_rows) : nullptr,
          system.ds ? system.ds + layout.first_slack[k] : nullptr,
          system.z + first,
          system.lam + dynamics,
          system.lam + equalities,
          system.lam + inequalities};
}

Pivots RiccatiSolver::factorise_and_solve(const StageValues& jacobian, const StageValues& hessian,
                                          const NewtonSystem& system, Along* along) {
  for (std::size_t k = matrices_.count(); k-- > 0;) {
    if (along && ends_part(k)) along->before(k - k % Along::at_a_time, k + 1);
    const StageView stage = matrices_.view(k, &jacobian, &hessian);
    const StageVectors at = vectors(k, system);
    const StageFactor* after = next(k);
    if (!system.de) make_room(k, factors_[k], stage.equality_count + (after ? after->gamma - after->rank : 0));
    const Pivots pivots = run_.factorise_stage(stage, at, after, options, memory_, factors_[k]);
    if (pivots != Pivots::good) return pivots;
    run_.backward_stage(stage, at, after, memory_, factors_[k]);
  }
  const StageFactor& first = factors_.front();
  make_room(matrices_.count(), start_, first.gamma - first.rank);
  const Pivots pivots = run_.factorise_start(first, options, memory_, start_);
  if (pivots != Pivots::good) return pivots;
  run_.backward_start(first, memory_, start_);
  forward(jacobian, system, along);
  return Pivots::good;
}

void RiccatiSolver::solve(const StageValues& jacobian, const NewtonSystem& system) {
  for (std::size_t k = matrices_.count(); k-- > 0;)
    run_.backward_stage(matrices_.view(k, &jacobian, nullptr), vectors(k, system), next(k), memory_, factors_[k]);
  run_.backward_start(factors_.front(), memory_, start_);
  forward(jacobian, system, nullptr);
}

void RiccatiSolver::forward(const StageValues& jacobian, const NewtonSystem& system, Along* along) {
  const Layout& layout = matrices_.layout();
  run_.forward_start(start_, system.z + layout.first_state[0], left_.data(), memory_);
  for (std::size_t k = 0; k < matrices_.count(); ++k) {
    double* next_state = next(k) ? system.z + layout.first_state[k + 1] : nullptr;
    run_.forward_stage(matrices_.view(k, &jacobian, nullptr), vectors(k, system), factors_[k], next(k), next_state,
                       left_.data(), memory_);
    if (along && ends_part(k)) along->after(k - k % Along::at_a_time, k + 1);
  }
}

double RiccatiSolver::residual(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                               std::size_t begin, std::size_t end, StageResidual left) {
  const Layout& layout = matrices_.layout();
  double most = 0.0;
  const double* before = begin > 0 ? vectors(begin - 1, system).lam_dynamics : nullptr;
  for (std::size_t k = begin; k < end; ++k) {
    const StageVectors at = vectors(k, system);
    const StageView stage = matrices_.view(k, &jacobian, &hessian);
    const double* next_state = next(k) ? system.z + layout.first_state[k + 1] : nullptr;
    most = std::max(most, run_.residual_stage(stage, at, before, next_state, left, memory_));
    before = at.lam_dynamics;
    left.gradient += stage.nu + stage.nx;
    left.dynamics += stage.next;
    left.equalities += stage.equality_count;
    left.inequalities += stage.inequality_count;
  }
  return most;
}

}  // namespace robotraj::native
