#include "stage_parts.hpp"

#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/linear_algebra/linear_solver_return_flags.hpp>
#include <fatrop/ocp/aug_system_solver.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>
#include <fatrop/ocp/pd_solver_orig.hpp>
#include <fatrop/ocp/pd_system_orig.hpp>

#include <dlfcn.h>

namespace robotraj::native {

namespace {

using Ocp = fatrop::OcpType;
using Vector = FatropParts::Vector;

/// The pointer that `_kernels` reads; null where that library is not in the process.
FatropParts** slot() {
  using Slot = FatropParts** (*)();
  static const auto find = reinterpret_cast<Slot>(dlsym(RTLD_DEFAULT, "robotraj_fatrop_parts"));
  return find ? find() : nullptr;
}

/// Notes which calls arrive.
class Probe final : public FatropParts {
 public:
  const VectorKernels& vectors() const override { return vector_kernels_of(); }
  const Dims& made(const Dims& dims) override { return dims; }
  bool owns(const Jacobian&) override { return true; }
  bool owns(const Hessian&) override { return true; }
  void times(const Jacobian&, const Vector&, double, const Vector&, Vector&) override { seen |= 1; }
  void transposed_times(const Jacobian&, const Vector&, double, const Vector&, Vector&) override { seen |= 2; }
  void times(const Hessian&, const Vector&, double, const Vector&, Vector&) override { seen |= 4; }
  void set_zero(Hessian&) override {}
  int solve(const Jacobian&, Hessian&, const Vector&, const Vector*, const Vector&, const Vector&,
            const Vector&, Vector&, Vector&) override {
    seen |= 8;
    return fatrop::LinsolReturnFlag::SUCCESS;
  }
  int solve_again(const Jacobian&, const Vector*, const Vector&, const Vector&, const Vector&, Vector&,
                  Vector&) override {
    seen |= 16;
    return fatrop::LinsolReturnFlag::SUCCESS;
  }

  int seen = 0;
  static constexpr int all = 31;
};

bool probe() {
  if (!slot()) return false;
  const fatrop::ProblemInfo<Ocp> info(fatrop::ProblemDims<Ocp>(1, {0}, {1}, {0}, {0}));
  fatrop::Jacobian<Ocp> jacobian(info.dims);
  fatrop::Hessian<Ocp> hessian(info.dims);
  fatrop::PdSolverOrig<Ocp> solver(info, std::make_shared<fatrop::AugSystemSolver<Ocp>>(info));
  fatrop::VecRealAllocated d(1), f(1), x(1), out(1), none(0), s(0), g(0), lower(0), upper(0);
  d = 1.0;
  f = 1.0;
  x = 0.0;
  fatrop::LinearSystem<fatrop::PdSystemType<Ocp>> system(info, jacobian, hessian, d, true, none, none, none, none,
                                                         none, f, s, g, lower, upper);
  Probe probe;
  const StageParts::Lent lent(&probe);
  solver.solve_once(system, x);
  solver.solve_rhs(system, x);
  system.apply_on_right(x, 1.0, f, out);
  return probe.seen == Probe::all;
}

int flag_of(Pivots pivots) {
  switch (pivots) {
    case Pivots::indefinite: return fatrop::LinsolReturnFlag::INDEFINITE;
    case Pivots::dependent: return fatrop::LinsolReturnFlag::NOFULL_RANK;
    default: return fatrop::LinsolReturnFlag::SUCCESS;
  }
}

}  // namespace

bool StageParts::take_over() {
  static const bool arrives = probe();
  return arrives;
}

StageParts::Lent::Lent(FatropParts* parts) : before_(slot() ? *slot() : nullptr) {
  if (slot()) *slot() = parts;
}

StageParts::Lent::~Lent() {
  if (slot()) *slot() = before_;
}

StageParts::StageParts(const Info& info, const Pattern& jacobian, const Pattern& hessian)
    : matrices_(info, jacobian, hessian), solver_(matrices_) {}

StageValues* StageParts::find(Owned& owned, const void* matrix) {
  for (auto& [key, values] : owned)
    if (key == matrix) return &values;
  return nullptr;
}

StageValues& StageParts::values(Jacobian& jacobian) {
  StageValues* values = find(jacobians_, &jacobian);
  return values ? *values : jacobians_.emplace_back(&jacobian, matrices_.empty_jacobian()).second;
}

StageValues& StageParts::values(Hessian& hessian) {
  StageValues* values = find(hessians_, &hessian);
  return values ? *values : hessians_.emplace_back(&hessian, matrices_.empty_hessian()).second;
}

void StageParts::serve(fatrop::OptionRegistry& registry) {
  solver_.options = RiccatiOptions();
  jacobians_.clear();
  hessians_.clear();
  registry.register_option("linsol_lu_fact_tol", &StageParts::set_lu_tolerance, this);
  registry.register_option("linsol_pivot_tol", &StageParts::set_pivot_tolerance, this);
}

void StageParts::times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y, Vector& out) {
  matrices_.jacobian_times(*find(jacobians_, &jacobian), x.data(), alpha, y.data(), out.data());
}

void StageParts::transposed_times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y,
                                  Vector& out) {
  matrices_.transposed_times(*find(jacobians_, &jacobian), x.data(), alpha, y.data(), out.data());
}

void StageParts::times(const Hessian& hessian, const Vector& x, double alpha, const Vector& y, Vector& out) {
  matrices_.hessian_times(*find(hessians_, &hessian), x.data(), alpha, y.data(), out.data());
}

void StageParts::set_zero(Hessian& hessian) {
  StageValues& zeros = values(hessian);
  std::fill(zeros.begin(), zeros.end(), 0.0);
}

int StageParts::solve(const Jacobian& jacobian, Hessian& hessian, const Vector& d_x, const Vector* d_e,
                      const Vector& d_s, const Vector& f, const Vector& g, Vector& x, Vector& multipliers) {
  return solve(jacobian, hessian,
               {d_x.data(), d_e ? d_e->data() : nullptr, d_s.data(), f.data(), g.data(),
                g.data() + info().offset_g_eq_slack, x.data(), multipliers.data()},
               nullptr);
}

int StageParts::solve_again(const Jacobian& jacobian, const Vector* d_e, const Vector& d_s, const Vector& f,
                            const Vector& g, Vector& x, Vector& multipliers) {
  solve_again(jacobian, {nullptr, d_e ? d_e->data() : nullptr, d_s.data(), f.data(), g.data(),
                         g.data() + info().offset_g_eq_slack, x.data(), multipliers.data()});
  return fatrop::LinsolReturnFlag::SUCCESS;
}

int StageParts::solve(const Jacobian& jacobian, Hessian& hessian, const RiccatiSolver::System& system, Along* along) {
  return flag_of(solver_.factorise_and_solve(*find(jacobians_, &jacobian), values(hessian), system, along));
}

void StageParts::solve_again(const Jacobian& jacobian, const RiccatiSolver::System& system) {
  solver_.solve(*find(jacobians_, &jacobian), system);
}

double StageParts::residual(const Jacobian& jacobian, Hessian& hessian, const RiccatiSolver::System& system,
                            std::size_t begin, std::size_t end, const StageResidual& left) {
  return solver_.residual(*find(jacobians_, &jacobian), values(hessian), system, begin, end, left);
}

}  // namespace robotraj::native
