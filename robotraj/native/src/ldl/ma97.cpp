// The factorisation under the names that IPOPT calls HSL's MA97 by, so that IPOPT takes it for its linear solver.
//
// IPOPT opens the library that its option `hsllib` names. The structures are those of HSL_MA97's public C interface,
// version 2.8; none of HSL is here.
#include <cstddef>
#include <memory>

#include "factors.hpp"

namespace {

using robotraj::native::ldl::Factors;
using robotraj::native::ldl::Inertia;
using robotraj::native::ldl::Pattern;

struct Control {
  int f_arrays, action, nemin;
  double multiplier;
  int ordering, print_level, scaling;
  double small, u;
  int unit_diagnostics, unit_error, unit_warning;
  long factor_min;
  int solve_blas3;
  long solve_min;
  int solve_mf;
  double consist_tol;
  int ispare[5];
  double rspare[10];
};

struct Info {
  int flag, flag68, flag77, matrix_dup, matrix_rank, matrix_outrange, matrix_missing_diag, maxdepth, maxfront,
      num_delay;
  long num_factor, num_flops;
  int num_neg, num_sup, num_two, ordering, stat, maxsupernode;
  int ispare[4];
  double rspare[10];
};

constexpr int kNoMemory = -1, kSingular = -7, kSingularButFactored = 7;

}  // namespace

#define ROBOTRAJ_EXPORT extern "C" __attribute__((visibility("default")))

ROBOTRAJ_EXPORT void ma97_default_control_d(Control* control) {
  *control = Control{};
  control->nemin = 8;
  control->multiplier = 1.1;
  control->ordering = 5;
  control->small = 1e-20;
  control->u = 0.01;
  control->unit_diagnostics = control->unit_error = control->unit_warning = -1;
  control->consist_tol = 1e-12;
}

ROBOTRAJ_EXPORT void ma97_finalise_d(void** analysis, void** factors) {
  delete static_cast<Factors*>(*analysis);
  *analysis = *factors = nullptr;
}

ROBOTRAJ_EXPORT void ma97_free_akeep_d(void** analysis) {
  delete static_cast<Factors*>(*analysis);
  *analysis = nullptr;
}

ROBOTRAJ_EXPORT void ma97_analyse_d(int, int n, const int* ptr, const int* row, double*, void** analysis,
                                    const Control* control, Info* info, int*) {
  *info = Info{};
  try {
    const int from = control->f_arrays ? 1 : 0;
    Pattern pattern;
    pattern.n = n;
    for (int column = 0; column <= n; ++column) pattern.starts.push_back(ptr[column] - from);
    for (int e = 0; e < pattern.starts[n]; ++e) pattern.rows.push_back(row[e] - from);
    auto made = std::make_unique<Factors>(std::move(pattern));
    ma97_free_akeep_d(analysis);
    *analysis = made.release();
    info->ordering = control->ordering;
  } catch (const std::bad_alloc&) {
    info->flag = kNoMemory;
  }
}

ROBOTRAJ_EXPORT void ma97_factor_d(int, const int*, const int*, const double* values, void** analysis, void** factors,
                                   const Control* control, Info* info, double*) {
  *info = Info{};
  try {
    Factors& made = *static_cast<Factors*>(*analysis);
    const Inertia found = made.factorise(values, control->u, control->small);
    *factors = *analysis;
    info->matrix_rank = made.pattern().n - found.zero;
    info->num_neg = found.negative;
    info->num_delay = found.delayed;
    info->num_factor = static_cast<long>(made.entries());
    info->num_flops = made.tree().products;
    info->maxfront = made.tree().largest;
    info->num_sup = static_cast<int>(made.tree().nodes.size());
    if (found.zero > 0) info->flag = control->action ? kSingularButFactored : kSingular;
  } catch (const std::bad_alloc&) {
    info->flag = kNoMemory;
  }
}

ROBOTRAJ_EXPORT void ma97_solve_d(int, int count, double* x, int step, void** analysis, void**, const Control*,
                                  Info* info) {
  const int kept = info->num_neg;
  *info = Info{};
  info->num_neg = kept;
  Factors& made = *static_cast<Factors*>(*analysis);
  for (int i = 0; i < count; ++i) made.solve(x + static_cast<std::ptrdiff_t>(i) * step);
}

ROBOTRAJ_EXPORT void ma97_factor_solve_d(int type, const int* ptr, const int* row, const double* values, int count,
                                         double* x, int step, void** analysis, void** factors, const Control* control,
                                         Info* info, double* scale) {
  ma97_factor_d(type, ptr, row, values, analysis, factors, control, info, scale);
  if (info->flag < 0) return;
  Factors& made = *static_cast<Factors*>(*analysis);
  for (int i = 0; i < count; ++i) made.solve(x + static_cast<std::ptrdiff_t>(i) * step);
}
