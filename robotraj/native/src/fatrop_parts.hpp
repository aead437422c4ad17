// Who does the linear algebra of fatrop's stages in its place.
#pragma once

namespace fatrop {
template <typename ProblemType>
struct Jacobian;
template <typename ProblemType>
struct Hessian;
template <typename ProblemType>
struct ProblemDims;
class OcpType;
class VecRealView;
}  // namespace fatrop

namespace robotraj::native {

struct VectorKernels;

/// What `_kernels` asks before it lets fatrop's own functions work: matrices that are not owned are left to fatrop.
class FatropParts {
 public:
  using Jacobian = fatrop::Jacobian<fatrop::OcpType>;
  using Hessian = fatrop::Hessian<fatrop::OcpType>;
  using Dims = fatrop::ProblemDims<fatrop::OcpType>;
  using Vector = fatrop::VecRealView;

  /// What is done with vectors over all stages, for this processor.
  virtual const VectorKernels& vectors() const = 0;

  /// Dimensions of the dense matrices that fatrop makes where it asks for `dims`: the least where they stay unused.
  virtual const Dims& made(const Dims& dims) = 0;
  virtual bool owns(const Jacobian& jacobian) = 0;
  virtual bool owns(const Hessian& hessian) = 0;

  /// out = alpha y + A x, or A' x.
  virtual void times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y, Vector& out) = 0;
  virtual void transposed_times(const Jacobian& jacobian, const Vector& x, double alpha, const Vector& y,
                                Vector& out) = 0;
  virtual void times(const Hessian& hessian, const Vector& x, double alpha, const Vector& y, Vector& out) = 0;
  virtual void set_zero(Hessian& hessian) = 0;

  /// fatrop's augmented system; a LinsolReturnFlag. D_e is null where it is zero.
  virtual int solve(const Jacobian& jacobian, Hessian& hessian, const Vector& d_x, const Vector* d_e,
                    const Vector& d_s, const Vector& f, const Vector& g, Vector& x, Vector& multipliers) = 0;
  /// The same with the factors of the last one.
  virtual int solve_again(const Jacobian& jacobian, const Vector* d_e, const Vector& d_s, const Vector& f,
                          const Vector& g, Vector& x, Vector& multipliers) = 0;

 protected:
  ~FatropParts() = default;
};

}  // namespace robotraj::native

/// Where `_kernels` looks for the parts of the solve that this thread is in; null where fatrop does its own work.
extern "C" robotraj::native::FatropParts** robotraj_fatrop_parts();
