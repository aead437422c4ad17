// fatrop's linear algebra of stages, handed to whoever owns the matrices.
//
// This library is in the process before fatrop is, so that fatrop's calls of the functions below are bound to these.
// They pass on to fatrop's own, found by name, what nobody owns: casadi's plugin works as ever. The names are those of
// the C++ ABI; an object comes before the arguments.
#include "fatrop_parts.hpp"

#include "fatrop_own.hpp"

namespace {

using robotraj::native::FatropParts;
using Jacobian = const FatropParts::Jacobian&;
using Hessian = const FatropParts::Hessian&;
using Dims = const FatropParts::Dims&;
using Vector = const FatropParts::Vector&;
using Result = FatropParts::Vector&;
using Pointer = const void*;

thread_local FatropParts* parts = nullptr;

}  // namespace

#define MAKE_JACOBIAN _ZN6fatrop8JacobianINS_7OcpTypeEEC1ERKNS_11ProblemDimsIS1_EE
#define MAKE_HESSIAN _ZN6fatrop7HessianINS_7OcpTypeEEC1ERKNS_11ProblemDimsIS1_EE
#define PRODUCT_OF_JACOBIAN \
  _ZNK6fatrop8JacobianINS_7OcpTypeEE14apply_on_rightERKNS_11ProblemInfoIS1_EERKNS_11VecRealViewEdS9_RS7_
#define TRANSPOSED_PRODUCT_OF_JACOBIAN \
  _ZNK6fatrop8JacobianINS_7OcpTypeEE24transpose_apply_on_rightERKNS_11ProblemInfoIS1_EERKNS_11VecRealViewEdS9_RS7_
#define PRODUCT_OF_HESSIAN \
  _ZNK6fatrop7HessianINS_7OcpTypeEE14apply_on_rightERKNS_11ProblemInfoIS1_EERKNS_11VecRealViewEdS9_RS7_
#define ZERO_OF_HESSIAN _ZN6fatrop7HessianINS_7OcpTypeEE8set_zeroEv
#define SOLVE                                                                                                      \
  _ZN6fatrop15AugSystemSolverINS_7OcpTypeEE5solveERKNS_11ProblemInfoIS1_EERNS_8JacobianIS1_EERNS_7HessianIS1_EERKNS_11VecRealViewESF_SF_SF_RSD_SG_
#define SOLVE_DAMPED                                                                                               \
  _ZN6fatrop15AugSystemSolverINS_7OcpTypeEE5solveERKNS_11ProblemInfoIS1_EERNS_8JacobianIS1_EERNS_7HessianIS1_EERKNS_11VecRealViewESF_SF_SF_SF_RSD_SG_
#define SOLVE_AGAIN                                                                                                \
  _ZN6fatrop15AugSystemSolverINS_7OcpTypeEE9solve_rhsERKNS_11ProblemInfoIS1_EERKNS_8JacobianIS1_EERKNS_7HessianIS1_EERKNS_11VecRealViewESH_SH_RSF_SI_
#define SOLVE_DAMPED_AGAIN                                                                                         \
  _ZN6fatrop15AugSystemSolverINS_7OcpTypeEE9solve_rhsERKNS_11ProblemInfoIS1_EERKNS_8JacobianIS1_EERKNS_7HessianIS1_EERKNS_11VecRealViewESH_SH_SH_RSF_SI_

EXPORTED FatropParts** robotraj_fatrop_parts() { return &parts; }

EXPORTED void MAKE_JACOBIAN(void* self, Dims dims) { PASS(MAKE_JACOBIAN, self, parts ? parts->made(dims) : dims); }

EXPORTED void MAKE_HESSIAN(void* self, Dims dims) { PASS(MAKE_HESSIAN, self, parts ? parts->made(dims) : dims); }

EXPORTED void PRODUCT_OF_JACOBIAN(Jacobian self, Pointer info, Vector x, double alpha, Vector y, Result out) {
  if (parts && parts->owns(self)) return parts->times(self, x, alpha, y, out);
  PASS(PRODUCT_OF_JACOBIAN, self, info, x, alpha, y, out);
}

EXPORTED void TRANSPOSED_PRODUCT_OF_JACOBIAN(Jacobian self, Pointer info, Vector x, double alpha, Vector y,
                                             Result out) {
  if (parts && parts->owns(self)) return parts->transposed_times(self, x, alpha, y, out);
  PASS(TRANSPOSED_PRODUCT_OF_JACOBIAN, self, info, x, alpha, y, out);
}

EXPORTED void PRODUCT_OF_HESSIAN(Hessian self, Pointer info, Vector x, double alpha, Vector y, Result out) {
  if (parts && parts->owns(self)) return parts->times(self, x, alpha, y, out);
  PASS(PRODUCT_OF_HESSIAN, self, info, x, alpha, y, out);
}

EXPORTED void ZERO_OF_HESSIAN(FatropParts::Hessian& self) {
  if (parts && parts->owns(self)) return parts->set_zero(self);
  PASS(ZERO_OF_HESSIAN, self);
}

EXPORTED int SOLVE(Pointer self, Pointer info, Jacobian jacobian, FatropParts::Hessian& hessian, Vector d_x, Vector d_s, Vector f,
                   Vector g, Result x, Result multipliers) {
  if (parts && parts->owns(jacobian)) return parts->solve(jacobian, hessian, d_x, nullptr, d_s, f, g, x, multipliers);
  PASS(SOLVE, self, info, jacobian, hessian, d_x, d_s, f, g, x, multipliers);
}

EXPORTED int SOLVE_DAMPED(Pointer self, Pointer info, Jacobian jacobian, FatropParts::Hessian& hessian, Vector d_x, Vector d_e,
                          Vector d_s, Vector f, Vector g, Result x, Result multipliers) {
  if (parts && parts->owns(jacobian)) return parts->solve(jacobian, hessian, d_x, &d_e, d_s, f, g, x, multipliers);
  PASS(SOLVE_DAMPED, self, info, jacobian, hessian, d_x, d_e, d_s, f, g, x, multipliers);
}

EXPORTED int SOLVE_AGAIN(Pointer self, Pointer info, Jacobian jacobian, Hessian hessian, Vector d_s, Vector f,
                         Vector g, Result x, Result multipliers) {
  if (parts && parts->owns(jacobian)) return parts->solve_again(jacobian, nullptr, d_s, f, g, x, multipliers);
  PASS(SOLVE_AGAIN, self, info, jacobian, hessian, d_s, f, g, x, multipliers);
}

EXPORTED int SOLVE_DAMPED_AGAIN(Pointer self, Pointer info, Jacobian jacobian, Hessian hessian, Vector d_e,
                                Vector d_s, Vector f, Vector g, Result x, Result multipliers) {
  if (parts && parts->owns(jacobian)) return parts->solve_again(jacobian, &d_e, d_s, f, g, x, multipliers);
  PASS(SOLVE_DAMPED_AGAIN, self, info, jacobian, hessian, d_e, d_s, f, g, x, multipliers);
}
